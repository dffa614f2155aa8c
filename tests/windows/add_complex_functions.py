# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes NumPy 2 for Windows loadable in Wine: complex_functions.c becomes a DLL beside Python, and NumPy's
modules ask that one for all functions of mathematics.

    python3 add_complex_functions.py FOLDER      FOLDER: of python.exe, with NumPy in Lib/site-packages
"""

import re
import subprocess
import sys
from pathlib import Path

COMPILER = "x86_64-w64-mingw32-"
ASKED, GIVEN = b"api-ms-win-crt-math-l1-1-0.dll", b"wine-lacks-complex-numbers.dll"  # as long as each other
OWN = re.compile(r"(c(?:cosh?|exp|sinh?|tanh?|pow|abs|arg|imag|real))(?:(f)|l)?")


def imported(module):
    """The names that a module asks the library for."""
    output = subprocess.run(
        [f"{COMPILER}objdump", "-p", module], check=True, capture_output=True, text=True
    ).stdout
    parts = re.split(r"DLL Name: (\S+)", output)
    of_library = [text for name, text in zip(parts[1::2], parts[2::2], strict=True) if name.encode() == ASKED]
    return {name for text in of_library for name in re.findall(r"^\s+[0-9a-f]+\s+\d+\s+(\w+)$", text, re.M)}


def main(folder):
    packages = Path(folder) / "Lib" / "site-packages"
    modules = [path for path in packages.rglob("*") if path.suffix in (".pyd", ".dll")]
    names = set().union(*map(imported, modules))
    if not names:
        return  # it was done before
    # A long double of Microsoft's is a double.
    exports = [
        f"{name}=own_{own[1]}{own[2] or ''}" if (own := OWN.fullmatch(name)) else f"{name}=ucrtbase.{name}"
        for name in sorted(names)
    ]
    definition = Path(folder) / "complex_functions.def"
    definition.write_text("\n".join(["EXPORTS", *exports]) + "\n", encoding="ascii")
    source = Path(__file__).with_name("complex_functions.c")
    made = Path(folder) / GIVEN.decode()
    subprocess.run(
        [f"{COMPILER}gcc", "-O2", "-shared", "-static", "-o", made, source, definition], check=True
    )
    for module in modules:
        content = module.read_bytes()
        if ASKED in content:
            module.write_bytes(content.replace(ASKED, GIVEN))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
