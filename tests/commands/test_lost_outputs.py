"""What was computed is kept where outputs are closed, disks full and folders not to be written."""

import errno
import json
import os
import resource
import subprocess
from contextlib import nullcontext

import pytest
from commandline import COMMAND, PRECIOUS, RUN, Left, Loaded

from ngdgc import ContactSolution, ProblemError
from ngdgc.cases import example_4_1
from ngdgc.cli import Main
from ngdgc.commands.files import Files, Whole


def Shell(command):
    return subprocess.run(["bash", "-o", "pipefail", "-c", f"{COMMAND} {command}"], capture_output=True, text=True, timeout=120)


@pytest.mark.slow
@pytest.mark.parametrize("redirect, code, words", [(">&- 2>&-", 0, ""), (">/dev/full", 2, "No space left on device"),
                                                   ("| head -n 1", 0, "")])
def test_an_output_that_nobody_takes_costs_no_file(redirect, code, words, tmp_path):
    done = Shell(f"run example_4_1 --n 2 --out {tmp_path} {redirect}")
    assert done.returncode == code and words in done.stderr and done.stderr.count("\n") == bool(words)
    assert Loaded(tmp_path).converged and (tmp_path / "history.png").stat().st_size > 5000
    assert json.loads((tmp_path / "report.json").read_text())["converged"] is True


@pytest.mark.slow
@pytest.mark.parametrize("redirect, code, words", [(">&-", 0, "cannot be written: it is closed"), ("2>&-", 0, ""),
                                                   (">/dev/full", 2, "No space left on device"), ("| true", 0, "")])
def test_commands_that_only_print_tell_who_does_not_listen(redirect, code, words):
    done = Shell(f"cases {redirect}")
    assert done.returncode == code and words in done.stderr and done.stderr.count("\n") == bool(words)
    assert ("example_4_1" in done.stdout) == (redirect == "2>&-")


@pytest.mark.slow
def test_a_study_goes_on_when_its_reader_has_gone(tmp_path):
    done = Shell(f"locking --method h1 --order 1 --n 2 --lam 1 10 --out {tmp_path} | true")
    assert done.returncode == 0 and "Traceback" not in done.stderr and Left(tmp_path) == {"locking.txt", "locking.png"}


@pytest.mark.slow
@pytest.mark.parametrize("fails, left", [("solution", {"report.json", "report.txt"}),
                                         ("report.txt", {"solution/", "report.json"}),
                                         ("law.png", PRECIOUS | {"solution.html", "solution.vtu", "contact.vtu", "setting.png",
                                                                 "contact.png", "deformed.png"})])
def test_a_full_disk_is_one_line_and_the_report_is_printed(fails, left, tmp_path, capsys, monkeypatch):
    def Full(path):
        if path.name == fails:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return nullcontext(path)

    monkeypatch.setattr("ngdgc.commands.files.Whole", Full)
    monkeypatch.setattr(ContactSolution, "Save", lambda self, path: path.mkdir() if fails != path.name else Full(path))
    assert Main([*RUN[1:], str(tmp_path / "new")]) == 2
    output = capsys.readouterr()
    assert output.err.count("\n") == 1 and "No space left on device; choose another --out" in output.err
    assert "int p_n" in output.out and "Balance" in output.out
    assert (f": {', '.join(sorted(left, key=output.out.rindex))}\n" in output.out) if left else not (tmp_path / "new").exists()


@pytest.mark.slow
def test_a_limit_of_file_sizes_leaves_what_fits(tmp_path):
    """A real one: the solution fits, the page with the viewer does not."""
    limit = 100_000
    done = subprocess.run([*RUN, str(tmp_path)], capture_output=True, text=True, timeout=120,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
    assert done.returncode == 2 and "solution.html cannot be written: File too large" in done.stderr
    assert done.stderr.count("\n") == 1
    assert Loaded(tmp_path).converged and "int p_n" in done.stdout
    assert not [name for name in Left(tmp_path) if "html" in name]


def test_a_folder_that_cannot_be_is_refused_before_anything_is_solved(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(example_4_1, "Main", None)
    (tmp_path / "file").write_text("")
    (tmp_path / "taken" / "report.txt").mkdir(parents=True)
    (tmp_path / "taken2").mkdir()
    (tmp_path / "taken2" / "solution").write_text("")
    for name, words in (("file", "File exists"), ("file/below", "Not a directory"), ("a/" + 300 * "b", "File name too long"),
                        ("taken", "report.txt: Is a directory"), ("taken2", "solution/: Not a directory")):
        assert Main([*RUN[1:], str(tmp_path / name)]) == 2
        message = capsys.readouterr().err
        assert words in message and "choose another --out" in message and message.count("\n") == 1
    assert not (tmp_path / "a").exists()


def test_an_error_leaves_no_folder_behind(tmp_path, capsys):
    """Those that were there stay, and so does what is in them."""
    (tmp_path / "mine").mkdir()
    for name in ("new", "deep/er/results", "mine"):
        assert Main([*RUN[1:], str(tmp_path / name), "--penalty", "1e-3"]) == 2
        assert "loses coercivity" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["mine"]
    with pytest.raises(ProblemError), Files(tmp_path / "kept") as files:
        files.Text("numbers.txt", "1 2 3")
        with files.Growing("empty.txt"):
            raise ProblemError("later")
    assert Left(tmp_path) == {"kept/numbers.txt"}


def test_a_file_takes_the_place_of_the_old_one_when_it_is_complete(tmp_path):
    path = tmp_path / "table.txt"
    path.write_text("old")
    with pytest.raises(ZeroDivisionError), Whole(path) as temporary:
        temporary.write_text("ne")
        assert temporary.suffix == ".txt" and path.read_text() == "old"
        1 / 0       # noqa: B018
    assert path.read_text() == "old" and Left(tmp_path) == {"table.txt"}
    with Whole(path) as temporary:
        temporary.write_text("new")
    assert path.read_text() == "new" and Left(tmp_path) == {"table.txt"}
