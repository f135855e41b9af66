"""What needs PETSc and MPI runs where they are installed; where not, the suite says that it left it out."""

from importlib.util import find_spec

FOUND = all(find_spec(name) for name in ("petsc4py", "mpi4py"))
collect_ignore = [] if FOUND else ["test_ranks.py"]


def pytest_terminal_summary(terminalreporter):
    if not FOUND:
        terminalreporter.write_line("tests/distributed/test_ranks.py was left out: petsc4py and mpi4py are not installed here; "
                                    ".ci/distributed installs them and runs it")
