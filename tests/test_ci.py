"""`.ci/run` does what a user does who follows README.md; `.ci/versions` runs files that are there."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
# In place of an interpreter: `python3 -m venv FOLDER` makes an environment whose pip and pytest note how they were called.
PYTHON = """#!/bin/sh
mkdir -p "$3/bin"
echo "PATH=$3/bin:\\$PATH" > "$3/bin/activate"
for name in pip pytest; do
    printf '#!/bin/sh\\necho "$0 $*" >> "%s"\\nexit $'"$name"'\\n' "$NOTES" > "$3/bin/$name"
    chmod +x "$3/bin/$name"
done
"""


@pytest.fixture
def checkout(tmp_path):
    """A checkout with what the script reads."""
    folder = tmp_path / "checkout"
    (folder / ".ci").mkdir(parents=True)
    shutil.copy(ROOT / ".ci" / "run", folder / ".ci")
    shutil.copy(ROOT / "README.md", folder)
    (folder / ".ci" / "distributed").write_text('#!/bin/sh\necho "$0 $*" >> "$NOTES"\nexit $ranks\n')
    (folder / ".ci" / "distributed").chmod(0o755)
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "python3").write_text(PYTHON)
    (tmp_path / "bin" / "python3").chmod(0o755)
    return folder


def Run(checkout, *, pip=0, pytest=0, ranks=0):
    """(exit code, lines with the command and the arguments of what was called)"""
    notes = checkout.parent / "notes"
    notes.write_text("")
    path = f"{checkout.parent / 'bin'}:{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "NOTES": str(notes), "pip": str(pip), "pytest": str(pytest),
                   "ranks": str(ranks)}
    done = subprocess.run([checkout / ".ci" / "run"], cwd=checkout.parent, env=environment, capture_output=True, text=True)
    return done.returncode, notes.read_text().splitlines()


def Named(script):
    """The files of tests that `.ci/versions` runs, as bash reads its list."""
    words = re.search(r"^tests=\((.*?)\)$", script, re.M | re.S).group(1)
    command = ["bash", "-c", "echo " + " ".join(words.split())]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()


def test_versions_are_tried_with_files_that_are_there():
    script = (ROOT / ".ci" / "versions").read_text()
    assert len(Named(script)) == 14 and all((ROOT / name).is_file() for name in Named(script))
    assert not all((ROOT / name).is_file() for name in Named(script.replace("linear/", "")))


def test_the_environment_is_where_a_user_makes_it_and_the_verdict_that_of_the_tests(checkout):
    folder = checkout / ".venv" / "bin"
    assert Run(checkout) == (0, [f"{folder}/pip install .[test]", f"{folder}/pytest tests",
                             ".ci/distributed found"])
    assert not (checkout / ".venv").exists()
    assert Run(checkout, pytest=1)[0] == 1 and Run(checkout, ranks=1)[0] == 1
    code, called = Run(checkout, pip=3)
    assert code == 3 and len(called) == 1       # without the package its tests would test another one
    (checkout / "README.md").write_text("no command")
    assert Run(checkout)[0] != 0


def test_an_environment_that_is_there_is_left_alone(checkout):
    mine = checkout / ".venv" / "bin" / "pip"
    mine.parent.mkdir(parents=True)
    mine.write_text("exit 7")
    code, called = Run(checkout)
    assert code == 0 and all(line.startswith(f"{checkout}/.venv-") for line in called[:2]) and len(called) == 3
    assert mine.read_text() == "exit 7" and [path.name for path in checkout.glob(".venv*")] == [".venv"]
