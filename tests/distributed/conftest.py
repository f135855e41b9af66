"""What needs PETSc and MPI runs where they are installed; where not, the end of the run says that it was left out."""

from running import RANKS

collect_ignore = [] if RANKS else ["test_ranks.py"]
