# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scripts that draw for docs/ share: colors, and shapes that become an SVG file with the same
bytes on every run."""

from xml.sax.saxutils import escape

INK, GRAY, PALE = "#2b2b2b", "#8a8a8a", "#f1efec"
RED, BLUE = "#c0342b", "#1f5f8b"
SAND, STONE, CREAM = "#d9957c", "#b9b2b4", "#f0dfba"


class Drawing:
    """Shapes of one SVG file; `at` moves where the next ones stand.

    width, height: of the picture, in pixels; script: the file in scripts/ that draws it.
    """

    def __init__(self, width, height, script):
        self.width, self.height, self.script = width, height, script
        self.lines: list[str] = []
        self.x, self.y = 0.0, 0.0

    def at(self, x, y):
        self.x, self.y = x, y

    def _place(self, point):
        return f"{self.x + point[0]:.1f},{self.y + point[1]:.1f}"

    def add(self, element):
        self.lines.append(element)

    def rect(self, x, y, width, height, fill=PALE, stroke=INK, dash="", radius=5):
        dashes = f' stroke-dasharray="{dash}"' if dash else ""
        self.add(
            f'<rect x="{self.x + x:.1f}" y="{self.y + y:.1f}" width="{width}" height="{height}" '
            f'rx="{radius}" fill="{fill}" stroke="{stroke}"{dashes}/>'
        )

    def polygon(self, points, fill="none", stroke=INK, width=1.0):
        corners = " ".join(self._place(p) for p in points)
        self.add(f'<polygon points="{corners}" fill="{fill}" stroke="{stroke}" stroke-width="{width}"/>')

    def path(self, points, stroke=INK, width=1.5, dash="", end=""):
        corners = " ".join(self._place(p) for p in points)
        dashes = f' stroke-dasharray="{dash}"' if dash else ""
        marker = f' marker-end="url(#{end})"' if end else ""
        self.add(
            f'<polyline points="{corners}" fill="none" stroke="{stroke}" stroke-width="{width}"'
            f"{dashes}{marker}/>"
        )

    def dot(self, point, fill=INK, radius=3.2, stroke="white"):
        x, y = self._place(point).split(",")
        self.add(f'<circle cx="{x}" cy="{y}" r="{radius}" fill="{fill}" stroke="{stroke}"/>')

    def text(self, x, y, words, size=12.5, bold=False, fill=INK, anchor="start"):
        weight = ' font-weight="bold"' if bold else ""
        self.add(
            f'<text x="{self.x + x:.1f}" y="{self.y + y:.1f}" font-size="{size}"{weight} fill="{fill}" '
            f'text-anchor="{anchor}">{escape(words)}</text>'
        )

    def lines_of_text(self, x, y, lines, size=12.5, fill=INK):
        for number, line in enumerate(lines):
            self.text(x, y + number * (size + 4), line, size, fill=fill)

    def svg(self):
        body = "\n".join(self.lines)
        arrow = '<path d="M0,0 L8,4 L0,8 z" fill="{}"/>'
        markers = "".join(
            f'<marker id="{name}" markerWidth="8" markerHeight="8" refX="7" refY="4" orient="auto" '
            f'markerUnits="userSpaceOnUse">{arrow.format(color)}</marker>'
            for name, color in (("ink", INK), ("red", RED))
        )
        return (
            f"<!-- SPDX-License-Identifier: GPL-3.0-or-later; drawn by scripts/{self.script} -->\n"
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width} {self.height}" '
            f'font-family="DejaVu Sans, Verdana, Helvetica, sans-serif">\n<defs>{markers}</defs>\n'
            f'<rect width="{self.width}" height="{self.height}" fill="white"/>\n{body}\n</svg>\n'
        )
