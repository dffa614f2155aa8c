# SPDX-License-Identifier: GPL-3.0-or-later
"""The guide and the reference as web pages, for the zip.

Links between them, to the examples and to the pictures stay; other links become plain text, because what they
lead to is not in the zip. Large pictures are as wide as a page shows them, so that the zip stays small.
"""

import html
import re
from functools import cache
from io import BytesIO
from pathlib import Path, PurePosixPath
from posixpath import normpath, relpath
from urllib.parse import urldefrag, urlsplit

from markdown_it import MarkdownIt
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
PARSER = MarkdownIt("commonmark", {"html": True}).enable("table")
# What the guide and the reference refer to beside themselves.
OTHERS = ("docs/dev/geometry.md", "docs/dev/meshing.md")
LARGE, WIDTH = 8_000, 736  # bytes of a picture that is made smaller; pixels, as wide as a page
MOVING, SHORT = 400, 70  # pixels, the width of a moving one; milliseconds of a frame that it does without
QUALITY = 34  # of a picture as WebP, which takes half of what JPEG does
QUALITY_MOVING = 26  # of its frames, of which each is seen for a moment
_SOURCE = re.compile(r'<img[^>]* src="([^"]+)"')
PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>{title}</title><style>
body {{ font: 16px/1.5 sans-serif; color: #222; max-width: 46em; margin: 2em auto; padding: 0 1em }}
img {{ max-width: 100% }} nav {{ font-size: 14px }}
pre, code {{ font: 14px/1.4 monospace; background: #f3f3f3 }} pre {{ padding: 0.7em; overflow: auto }}
table {{ border-collapse: collapse; display: block; overflow: auto }}
th, td {{ border: 1px solid #ccc; padding: 0.2em 0.6em; text-align: left; vertical-align: top }}
</style></head><body>
<nav><a href="{guide}">RealModel user guide</a></nav>
{body}</body></html>
"""


def web_pages():
    """{path in the add-on's folder: bytes} of all pages and their pictures."""
    documents = [
        *ROOT.glob("docs/*.md"),
        *ROOT.glob("docs/guide/*.md"),
        *ROOT.glob("docs/reference/*.md"),
        *map(ROOT.joinpath, OTHERS),
    ]
    names = sorted(path.relative_to(ROOT).as_posix() for path in documents)
    files = {}
    for name in names:
        page, pictures = _page(name, names)
        files[_target(name)] = page.encode()
        files.update(map(_in_zip, pictures))
    return files


@cache
def _in_zip(picture):
    """The name and the bytes of a picture in the zip."""
    content = (ROOT / picture).read_bytes()
    if len(content) <= LARGE or picture.endswith(".svg"):
        return picture, content
    image = Image.open(BytesIO(content))
    smaller = BytesIO()
    if getattr(image, "is_animated", False):
        _save_moving(image, smaller)
    else:
        image.thumbnail((WIDTH, image.height))
        image.convert("RGB").save(smaller, "WEBP", quality=QUALITY, method=6)
    if smaller.tell() >= len(content):
        return picture, content
    return str(PurePosixPath(picture).with_suffix(".webp")), smaller.getvalue()


def _save_moving(image, to):
    """Writes a moving picture as wide as MOVING, without the frames that dissolve."""
    frames, durations = [], []
    for number in range(image.n_frames):
        image.seek(number)
        image.load()  # then the duration is known
        duration = image.info["duration"]
        if frames and duration < SHORT:
            durations[-1] += duration
            continue
        frame = image.convert("RGB")
        frame.thumbnail((MOVING, frame.height))
        frames.append(frame)
        durations.append(duration)
    frames[0].save(
        to,
        "WEBP",
        save_all=True,
        append_images=frames[1:],
        duration=durations,
        loop=0,
        quality=QUALITY_MOVING,
        method=6,
    )


def _target(name):
    """docs/guide/tour.md becomes docs/guide/tour.html, a README.md the index of its folder."""
    path = PurePosixPath(name)
    return str(path.with_name("index.html") if path.name == "README.md" else path.with_suffix(".html"))


def _page(name, names):
    """The page of a document, and the names of its pictures."""
    tokens = PARSER.parse((ROOT / name).read_text(encoding="utf-8"))
    folder = str(PurePosixPath(name).parent)
    pictures, title = set(), name
    for number, token in enumerate(tokens):
        if token.type == "heading_open":
            text = "".join(part.content for part in tokens[number + 1].children)
            token.attrSet("id", slug(text))
            title = text if token.tag == "h1" else title
        if token.type == "html_block":  # a picture with a width
            for address in _SOURCE.findall(token.content):
                picture = normpath(f"{folder}/{address}")
                pictures.add(picture)
                token.content = token.content.replace(address, relpath(_in_zip(picture)[0], folder))
        if token.type == "inline":
            token.children = _with_links(token.children, folder, names)
            for part in token.children:
                if part.type == "image":
                    picture = normpath(f"{folder}/{part.attrs['src']}")
                    pictures.add(picture)
                    part.attrSet("src", relpath(_in_zip(picture)[0], folder))
    body = PARSER.renderer.render(tokens, PARSER.options, {})
    guide = relpath("docs/guide/index.html", folder)
    return PAGE.format(title=html.escape(title), guide=guide, body=body), pictures


def slug(text):
    """The anchor of a heading, as GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", text.strip().lower()).replace(" ", "-")


def _with_links(parts, folder, names):
    """The parts of a paragraph with links as they are in the zip."""
    kept, opened = [], []
    for part in parts:
        if part.type == "link_open":
            address = _address(part.attrs["href"], folder, names)
            opened.append(address)
            if address is None:
                continue
            part.attrSet("href", address)
        elif part.type == "link_close" and opened.pop() is None:
            continue
        kept.append(part)
    return kept


def _address(href, folder, names):
    """A link of a document as it is in the zip; None where nothing is there."""
    if urlsplit(href).scheme or href.startswith("#"):
        return href
    path, anchor = urldefrag(href)
    name = normpath(f"{folder}/{path}")
    if name in names:
        name = _target(name)
    elif not name.startswith("blend_samples/"):
        return None
    return relpath(name, folder) + (f"#{anchor}" if anchor else "")
