# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the looks of objects, which other programs cannot compute, baked by Cycles.

Objects get a UV map in which no two polygons share a place: that along the bedding
(core.display.box_projection), with its islands side by side. All is done with copies (temporary_copies),
picture by picture, and leaves only files, so that between two pictures the scene is as it was.
"""

import contextlib
from dataclasses import dataclass

import bpy
import numpy as np

from ...core import InputRefused
from ...core.display import box_projection
from ..host import versions
from ..objects import filled_beds, meshes, placing
from ..shading import looks, rock_layers

UV_MAP = "Baked"
KINDS = (  # items of an enum
    ("COLOR", "Base Color", "The color without light"),
    ("ROUGHNESS", "Roughness", "How matt the surface is"),
    ("NORMAL", "Normal", "The relief of the look, in tangent space with green upward (OpenGL)"),
    ("OCCLUSION", "Ambient Occlusion", "How far other rock hides the sky. Faces between beds are white"),
    (
        "DISPLACEMENT",
        "Displacement",
        "The height of the relief, of 32 bits: 0.5 is the mesh, and 0 and 1 are one texture unit from it",
    ),
)
LAYOUTS = (
    ("OBJECT", "One for Each Object", "Each object has pictures of its own, and one material"),
    ("ATLAS", "One Atlas", "All objects share one set of pictures, at the same density, and one material"),
    ("MATERIAL", "One for Each Look", "Each material with a look has pictures, which objects share"),
)
# of each kind: the pass, and samples of a pixel
_PASSES = {
    "COLOR": ("DIFFUSE", 2),
    "ROUGHNESS": ("ROUGHNESS", 1),
    "NORMAL": ("NORMAL", 2),
    "OCCLUSION": ("AO", 16),
    "DISPLACEMENT": ("EMIT", 2),
}
_GAP = 4.0  # pixels between islands; half of it is filled from either side
_HIDDEN = 0.25  # of the density of other faces: that of faces between two beds, which are seldom seen
_MOST_GAPS = 0.25  # of the width of a picture, where there are many islands


@dataclass(eq=False)
class _Group:
    """What has one picture. users: (the number of an object, its slots)."""

    name: str
    users: list


class Baking:
    """Pictures of some objects. kinds: of KINDS. layout: one of LAYOUTS. size: of a picture, pixels. folder:
    of the files, which exists; stem: how their names begin."""

    def __init__(self, kinds, layout, size, folder, stem=""):
        self._kinds = [key for key, *_ in KINDS if key in kinds]
        self._layout, self._size, self._folder, self._stem = layout, size, folder, stem
        self._groups, self._uvs, self._gap = [], [], 1.0

    def prepare(self, scene, copies):
        """Lays the polygons of copies out. Raises InputRefused where this Blender cannot bake."""
        self._groups = self._grouped(copies.items)
        if self._groups and not versions.cycles_available(scene):
            what = "this Blender has no Cycles, which bakes looks"
            raise InputRefused(what, advice="switch Bake Looks off")
        self._lay_out(copies.items)

    @property
    def steps(self):
        """(kind, group) of each picture."""
        return [(kind, group) for kind in self._kinds for group in self._groups]

    def path(self, group, kind):
        """The file of a picture."""
        ending = "exr" if kind == "DISPLACEMENT" else "png"
        return self._folder / f"{self._stem}{bpy.path.clean_name(group.name)}_{kind.lower()}.{ending}"

    def fit(self, copies):
        """Gives copies the UV map of the pictures, as the first one. Raises InputRefused where they have
        changed since."""
        for item, uv in zip(copies.items, self._uvs, strict=True):
            mesh = item.data
            if uv is None:
                continue  # nothing of it is baked
            if len(uv) != len(mesh.loops):
                raise InputRefused("it has changed while it was baked", item=item.name, advice="bake again")
            others = {
                layer.name: rock_layers.uv_of(layer).ravel()
                for layer in mesh.uv_layers
                if layer.name != UV_MAP
            }
            while len(mesh.uv_layers):
                mesh.uv_layers.remove(mesh.uv_layers[0])
            rock_layers.set_uv(mesh, UV_MAP, uv)
            for name, values in list(others.items())[:7]:
                mesh.uv_layers.new(name=name, do_init=False).data.foreach_set("uv", values)

    def make(self, context, copies, step):
        """Bakes one of `steps` to its file. Copies have been fitted; they keep their materials."""
        kind, group = step
        is_exact = kind == "DISPLACEMENT"
        image = bpy.data.images.new(group.name, self._size, self._size, float_buffer=is_exact)
        if kind != "COLOR":
            image.colorspace_settings.name = "Non-Color"
        new, before = {}, []
        try:
            for number, slots in group.users:
                of_object = copies.items[number].data.materials
                for slot in slots:
                    material = of_object[slot]
                    before.append((of_object, slot, material))
                    if material not in new:
                        new[material] = _to_bake(material, kind, image)
                    of_object[slot] = new[material]
            baked = [copies.items[number] for number, _ in group.users]
            placing.select(baked)
            if kind == "OCCLUSION":  # elsewhere it stays white
                image.generated_color = (1.0, 1.0, 1.0, 1.0)
            with _left_out(baked if kind == "OCCLUSION" else ()):
                self._bake(context.scene, kind)
            image.filepath_raw = str(self.path(group, kind))
            image.file_format = "OPEN_EXR" if is_exact else "PNG"
            image.save()
        finally:
            for of_object, slot, material in before:
                of_object[slot] = material
            bpy.data.batch_remove([*new.values(), image])

    def show(self, copies, folder, same_names=False):
        """Gives copies materials with the pictures, which are in a folder by now. same_names: they have the
        names of those that they replace. Returns the new materials and images."""
        made = []
        try:
            for group in self._groups:
                self._show(group, copies, folder, same_names and self._layout == "MATERIAL", made)
        except BaseException:
            bpy.data.batch_remove(made)
            raise
        return made

    def _show(self, group, copies, folder, same_name, made):
        number, slots = group.users[0]
        source = copies.items[number].data.materials[slots[0]]
        material = source.copy()
        made.append(material)
        material.name = copies.take_name(source) if same_name else f"{group.name} Baked"
        images = {}
        for kind in self._kinds:
            images[kind] = bpy.data.images.load(str(folder / self.path(group, kind).name))
            made.append(images[kind])
            if kind != "COLOR":
                images[kind].colorspace_settings.name = "Non-Color"
        looks.show_pictures(material, images)
        for number, slots in group.users:
            mesh = copies.items[number].data
            for slot in slots:
                mesh.materials[slot] = material
            if self._layout != "MATERIAL" and len(slots) == len(_used_slots(copies.items[number])):
                mesh.materials.clear()
                mesh.materials.append(material)
                mesh.polygons.foreach_set("material_index", np.zeros(len(mesh.polygons), np.int32))

    def uv(self, number):
        """(C, 2) of an object, or None where nothing of it is baked."""
        return self._uvs[number]

    def files(self):
        """The names of all files."""
        return [self.path(group, kind).name for kind, group in self.steps]

    def _grouped(self, items):
        groups = {}
        for number, item in enumerate(items):
            slots = [slot for slot in _used_slots(item) if self._is_baked(item.data.materials[slot])]
            if self._layout == "MATERIAL":
                for slot in slots:
                    name = item.data.materials[slot].name
                    groups.setdefault(name, _Group(name, [])).users.append((number, [slot]))
            elif slots:
                name = "Rock Atlas" if self._layout == "ATLAS" else item.name
                groups.setdefault(name, _Group(name, [])).users.append((number, slots))
        taken = set()
        for group in groups.values():  # names of files have fewer letters
            while self.path(group, "COLOR").name in taken:
                group.name += "_"
            taken.add(self.path(group, "COLOR").name)
        return list(groups.values())

    def _is_baked(self, material):
        # not those with pictures, such as baked ones, which would be looked up in the new UV map
        if material is None or material.node_tree is None or pictures(material):
            return False
        return self._layout != "MATERIAL" or material.get(looks.KEY, "FLAT") != "FLAT"

    def _lay_out(self, items):
        """The UV maps of the objects."""
        parts = {}
        for number, item in enumerate(items):
            matrix = np.array(item.matrix_world, np.float64)[:3, :3]
            places = meshes.mesh_coordinates(item.data).astype(np.float64) @ matrix.T
            arrays = rock_layers.arrays_of(item.data)
            made = rock_layers.projection(item.data, places, arrays, 1.0)
            is_hidden = _between_beds(item)
            if is_hidden is not None:
                density = np.where(np.repeat(is_hidden, np.diff(arrays[0])), _HIDDEN, 1.0)[:, None]
                made = box_projection.Projection(made.uv * density, 2 * made.chart + is_hidden)
            island = box_projection.islands(made, arrays)
            slots = _material_indices(item.data)
            counts = np.diff(arrays[0])
            parts[number] = made.uv, np.repeat(island, counts), np.repeat(slots, counts)
        self._uvs = [None] * len(items)
        for group in self._groups:
            rows = [np.flatnonzero(np.isin(parts[number][2], slots)) for number, slots in group.users]
            begin = np.cumsum([0, *(len(items[number].data.polygons) for number, _ in group.users)])
            uv = np.concatenate([parts[n][0][row] for (n, _), row in zip(group.users, rows, strict=True)])
            island = np.concatenate(
                [
                    parts[n][1][row] + first
                    for (n, _), row, first in zip(group.users, rows, begin, strict=False)
                ]
            )
            count = len(np.unique(island))
            gap = min(_GAP / self._size, _MOST_GAPS / count**0.5)
            self._gap = min(gap, self._gap)
            uv = box_projection.packed(uv, island, gap)
            ends = np.cumsum([len(row) for row in rows])
            for (number, _), row, piece in zip(group.users, rows, np.split(uv, ends[:-1]), strict=True):
                if self._uvs[number] is None:
                    self._uvs[number] = np.zeros_like(parts[number][0])
                self._uvs[number][row] = piece

    def _bake(self, scene, kind):
        name, samples = _PASSES[kind]
        with _renderer(scene, samples):
            bpy.ops.object.bake(
                type=name,
                pass_filter={"COLOR"} if kind == "COLOR" else set(),
                target="IMAGE_TEXTURES",
                save_mode="INTERNAL",
                normal_space="TANGENT",
                normal_r="POS_X",
                normal_g="POS_Y",
                normal_b="POS_Z",
                margin=max(1, int(self._gap * self._size / 2)),
                margin_type="EXTEND",  # neighboring faces may be in another picture
                use_clear=kind != "OCCLUSION",
                use_selected_to_active=False,
                use_split_materials=False,
            )


def pictures(material):
    """The nodes of a material that have an image."""
    nodes = () if material is None or material.node_tree is None else material.node_tree.nodes
    return [node for node in nodes if node.type == "TEX_IMAGE" and node.image is not None]


def _to_bake(material, kind, image):
    """A copy of a material that is baked to an image."""
    made = material.copy()
    if kind == "DISPLACEMENT":
        looks.show_height(made)
    looks.reduce(made, kind)
    node = made.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    made.node_tree.nodes.active = node
    return made


def _used_slots(item):
    used = np.unique(_material_indices(item.data)).tolist()
    return [slot for slot in used if slot < len(item.data.materials)]


def _material_indices(mesh):
    indices = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("material_index", indices)
    return indices


def _between_beds(item):
    """(F,) bool of the polygons of a bed; None of another object."""
    surface = rock_layers.values_of(item.data, meshes.FACE_SURFACE, np.int32)
    return None if surface is None or filled_beds.BED not in item else surface >= 0


@contextlib.contextmanager
def _left_out(items):
    """Faces between beds are not baked for a while: they have a slot without material."""
    before = []
    try:
        for item in items:
            is_hidden, indices = _between_beds(item), _material_indices(item.data)
            if is_hidden is not None:
                before.append((item.data, indices))
                item.data.materials.append(None)
                indices = np.where(is_hidden, len(item.data.materials) - 1, indices).astype(np.int32)
                item.data.polygons.foreach_set("material_index", indices)
        yield
    finally:
        for mesh, indices in before:
            mesh.materials.pop()
            mesh.polygons.foreach_set("material_index", indices)


@contextlib.contextmanager
def _renderer(scene, samples):
    """Cycles with few samples."""
    engine, had_settings = scene.render.engine, "cycles" in scene.keys()  # noqa: SIM118
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    before = cycles.samples, cycles.use_denoising
    cycles.samples, cycles.use_denoising = samples, False  # a build without a denoiser would bake nothing
    try:
        yield
    finally:
        cycles.samples, cycles.use_denoising = before
        scene.render.engine = engine
        if not had_settings:
            scene.pop("cycles", None)
