#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Gets the file of this example: 80 boreholes at Kai Tak, Hong Kong, in AGS 3.

    python3 blend_samples/kai_tak/fetch.py FOLDER                  from the public repository
    python3 blend_samples/kai_tak/fetch.py FOLDER --from COPY      from a folder that has the file

Needs Python alone. The file is the same in both cases: its checksum is compared.
"""

import argparse
import hashlib
import sys
import urllib.request
from pathlib import Path

NAME = "64475_ASD012162.ags"
REPOSITORY = "bedrock-engineer/bedrock-ge"
COMMIT = "5851edf67d69899721ebee9ec08c7258db0ae15f"
ADDRESS = f"https://raw.githubusercontent.com/{REPOSITORY}/{COMMIT}/examples/hk_kaitak_ags3/{NAME}"
SHA256 = "db77a99bea50c982e7e4a283fd85a90f85c3f6f767af5ede9a1ecb4112462d8c"
LICENSE = f"""\
{NAME}: ground investigation for the sports complex at Kai Tak, Hong Kong, 2016.
  client       Architectural Services Department; contractor: Gammon Construction Limited
  published    "GEO Data for Public Use", Civil Engineering and Development Department of Hong Kong
  copied from  https://github.com/{REPOSITORY}, commit {COMMIT[:12]}
  license      of that repository: Apache License 2.0 (http://www.apache.org/licenses/LICENSE-2.0)"""


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="where the file goes")
    parser.add_argument("--from", dest="copy", type=Path, metavar="COPY", help="a folder that has the file")
    options = parser.parse_args()
    try:
        content = read(options.copy)
        if hashlib.sha256(content).hexdigest() != SHA256:
            raise OSError("the checksum differs: it is another version of the file, or it is damaged")
        options.folder.mkdir(parents=True, exist_ok=True)
        (options.folder / NAME).write_bytes(content)
    except OSError as error:
        print(f"fetch.py: {options.copy / NAME if options.copy else ADDRESS}: {error}", file=sys.stderr)
        return 1
    print(f"{LICENSE}\n{options.folder / NAME}: {len(content):,} bytes, checksum right")
    return 0


def read(copy: Path | None) -> bytes:
    """The file, of a folder or of the repository. Raises OSError."""
    if copy is not None:
        return (copy / NAME).read_bytes()
    with urllib.request.urlopen(ADDRESS, timeout=60) as answer:
        return answer.read()


if __name__ == "__main__":
    sys.exit(main())
