#!/usr/bin/env bash
# meshio 5.3.5: read() of a file that it cannot read ends the Python process; except Exception does not catch that.
#
# One would guess: meshio.read raises meshio.ReadError, which one catches to say what is wrong or to try another reader.
#
# What happens: where the reader of the format raises ReadError, read() prints it and calls sys.exit(1), with and without file_format=.
# SystemExit is no Exception: a loop over files ends at the first such file, and so does a program that has results in memory.  The file
# below is one that Gmsh 4.15.2 writes by itself: a square of second order as Abaqus input, whose triangles are CPS6, which meshio does
# not know.
#
# Why it matters: reading is what one guards with try, and a study over meshes from several sources loses all that was computed.
#
# Source of the guess: meshio.ReadError is public and in its own code the error of all readers.
#
# A way round: except (Exception, SystemExit), or read the file with the reader of its format (meshio.abaqus.read), which raises ReadError.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet 'gmsh==4.15.2' 'meshio==5.3.5' 'numpy==2.2.6'
cd "$folder"
cat > find.py <<'PYTHON'
import subprocess
import sys

import gmsh
import meshio

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
gmsh.model.occ.synchronize()
gmsh.option.setNumber("Mesh.ElementOrder", 2)
gmsh.model.mesh.generate(2)
gmsh.write("square.inp")
gmsh.finalize()
kinds = [line.split("type=")[1].split(",")[0] for line in open("square.inp") if line.upper().startswith("*ELEMENT")]
print("meshio", meshio.__version__, "; Gmsh wrote", kinds)
assert meshio.__version__ == "5.3.5" and "CPS6" in kinds

script = """
import meshio
try:
    meshio.read("square.inp")
except Exception as error:
    print("caught", type(error).__name__)
print("and on")
"""
done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
print("exit code", done.returncode, "output", (done.stdout + done.stderr).split("\n")[:2])
assert done.returncode == 1 and "caught" not in done.stdout and "and on" not in done.stdout

try:
    meshio.abaqus.read("square.inp")
except meshio.ReadError as error:
    print("meshio.abaqus.read raises ReadError:", error)
else:
    raise AssertionError("it was read")
print("as described: read() ends the process")
PYTHON
"$folder/venv/bin/python" find.py
