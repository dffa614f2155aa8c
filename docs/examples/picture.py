# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of the examples: a model with its data and a legend, by PyVista.

Colors are flat, so that a block has the color of its legend; lines on the top show its shape.
"""

import sys

import numpy as np
import pyvista as pv
from PIL import Image, ImageChops, ImageDraw, ImageFont

INK = "#2b2b30"
WIDTH = 1200  # pixels of a picture
_FLAT = {"lighting": False, "show_scalar_bar": False}


class Picture:
    """A view of a model. exaggeration: of heights. toward: the direction from the model to the eye."""

    def __init__(self, exaggeration=1.0, toward=(0.5, -1.0, 0.6)):
        self.plot = pv.Plotter(window_size=(1600, 1200), off_screen=len(sys.argv) > 1)
        self.plot.enable_anti_aliasing("ssaa")
        self.plot.set_scale(zscale=exaggeration)
        self.exaggeration, self.toward = exaggeration, toward
        self.legend = {}  # {name: (color, shape of its mark)}

    def blocks(self, model, spacing=None, offset=(0, 0, 0)):
        """The blocks of a model. spacing: of the lines on its top; None: a twentieth of its longer side."""
        grid = model.to_pyvista().translate(offset)
        self.plot.add_mesh(grid, scalars="color", rgb=True, **_FLAT)
        for number in np.unique(grid["block"])[::-1]:
            cells = grid.extract_cells(grid["block"] == number)
            self._edges(cells.extract_surface(algorithm=None))
            self._name(model.blocks[number].name, cells["color"][0], "block")
        x0, x1, y0, y1, *_ = grid.bounds
        self._drape(grid.extract_surface(algorithm=None), spacing or max(x1 - x0, y1 - y0) / 20)

    def surface(self, mesh, name=None, color="#d0d0d0", opacity=1.0, spacing=None):
        """A surface in one color, with lines on it where there is a spacing."""
        self.plot.add_mesh(mesh, color=color, opacity=opacity, **_FLAT)
        self._edges(mesh)
        if spacing:
            self._drape(mesh, spacing)
        self._name(name, color, "block")

    def section(self, section):
        """The polygons of a section or a fence."""
        mesh = section.to_pyvista()
        self.plot.add_mesh(mesh, scalars="color", rgb=True, **_FLAT)
        for number in np.unique(mesh["block"])[::-1]:
            part = mesh.extract_cells(mesh["block"] == number)
            outline = part.extract_surface(algorithm=None).clean()
            self.lines(outline.extract_feature_edges(feature_edges=False, manifold_edges=False))
            self._name(section.block_names[number], part["color"][0], "block")

    def lines(self, mesh, color=INK, width=2, name=None, opacity=1.0):
        if mesh.n_points:
            self._in_front(mesh, -2, color=color, line_width=width, opacity=opacity)
        self._name(name, color, "line")

    def points(self, xyz, name=None, color="white", size=15):
        """color: one, or the name of a block that has it: then the mark in the legend is white."""
        self._name(name, "white" if color in self.legend else color, "point")
        color = self._color(color)
        cloud = pv.PolyData(np.asarray(xyz, float))
        for reach, shade, wide in (-600, INK, size + 7), (-800, color, size):
            self._in_front(cloud, reach, color=shade, point_size=wide, render_points_as_spheres=True)

    def hole(self, top, bottom, color):
        """An interval of a borehole, in the color of a block."""
        for reach, shade, width in (-300, INK, 15), (-350, self._color(color), 9):
            self._in_front(pv.Line(top, bottom), reach, color=shade, line_width=width)

    def dips(self, xyz, normals, size, name="dips", color="white"):
        """A disc in the bedding at each place, with a stroke toward younger rock."""
        stretch = np.array([1, 1, 1 / self.exaggeration])
        for place, normal in zip(np.asarray(xyz, float), np.asarray(normals, float), strict=True):
            normal = normal / np.linalg.norm(normal)
            disc = pv.Disc(center=place, inner=0, outer=size, normal=normal, c_res=30)
            self._in_front(disc, -4, color=color)
            self.lines(disc.extract_feature_edges(), width=2)
            self.lines(pv.Line(place, place + size * normal * stretch), width=4)
        self._name(name, color, "disc")

    def label(self, xyz, text):
        self.plot.add_point_labels(
            [np.asarray(xyz, float) * (1, 1, self.exaggeration)],
            [text],
            font_size=30,
            shape=None,
            show_points=False,
            always_visible=True,
            text_color="black",
        )

    def save(self):
        """Writes the picture to the file that the command line names; without one, opens a window."""
        self.plot.view_vector(np.array(self.toward))
        if len(sys.argv) < 2:
            self.plot.show()
            return
        image = Image.fromarray(self.plot.screenshot(return_img=True))
        edge = ImageChops.difference(image, Image.new("RGB", image.size, "white")).getbbox()
        image = image.crop(edge)
        image = image.resize((WIDTH - 40, round(image.height * (WIDTH - 40) / image.width)), Image.LANCZOS)
        legend = self._legend()
        page = Image.new("RGB", (WIDTH, image.height + legend.height + 50), "white")
        page.paste(image, (20, 20))
        page.paste(legend, (0, image.height + 40))
        page.save(sys.argv[1], quality=93)

    def _edges(self, skin):
        self.lines(skin.extract_feature_edges(40, boundary_edges=True, manifold_edges=False))

    def _drape(self, skin, spacing):
        """Lines of equal x and of equal y on the faces that look up: they show the shape."""
        skin = skin.compute_normals(point_normals=False, consistent_normals=False)
        top = skin.extract_cells(skin["Normals"][:, 2] > 1e-3)
        for axis, low, high in ("x", *top.bounds[0:2]), ("y", *top.bounds[2:4]):
            for at in np.arange(low + spacing, high, spacing):
                self.lines(top.slice(axis, origin=(at, at, 0)), width=1, opacity=0.3)

    def _in_front(self, mesh, reach, **look):
        """Draws points or lines over the faces that they lie on."""
        mapper = self.plot.add_mesh(mesh, **look, **_FLAT).mapper
        mapper.SetResolveCoincidentTopologyToPolygonOffset()
        mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(0, reach)
        mapper.SetRelativeCoincidentTopologyLineOffsetParameters(0, reach)
        mapper.SetRelativeCoincidentTopologyPointOffsetParameter(reach)

    def _color(self, color):
        return self.legend[color][0] if isinstance(color, str) and color in self.legend else color

    def _name(self, name, color, shape):
        if name:
            self.legend[name] = color, shape

    def _legend(self):
        """The names in rows, each behind its mark."""
        font, gap = ImageFont.load_default(28), 26
        x, y, places = gap, 0, []
        for name in self.legend:
            wide = 46 + font.getlength(name)
            if x + wide > WIDTH - gap:
                x, y = gap, y + 44
            places.append((x, y))
            x += wide + gap
        page = Image.new("RGB", (WIDTH, y + 44), "white")
        draw = ImageDraw.Draw(page)
        for (x, y), (name, (color, shape)) in zip(places, self.legend.items(), strict=True):
            fill = pv.Color(color).int_rgb
            if shape == "block":
                draw.rectangle((x, y + 4, x + 34, y + 32), fill, INK, 2)
            elif shape == "point":
                draw.ellipse((x + 6, y + 6, x + 28, y + 28), fill, INK, 3)
            elif shape == "disc":
                draw.ellipse((x, y + 12, x + 34, y + 26), fill, INK, 2)
                draw.line((x + 17, y + 18, x + 17, y + 2), INK, 3)
            else:
                draw.line((x, y + 18, x + 34, y + 18), fill, 5)
            draw.text((x + 46, y), name, "black", font)
        return page
