# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints as JSON the objects that another program reads from a 3D file.

    python read_scene.py FILE

{object: material, color (linear), picture (None, or mean and deviation of its pixels where the object shows
them, linear), properties, volume, low, high}. trimesh reads .glb and .obj, Pixar's library USD. The exit
status is 3, with the reason, where one of them is not installed.
"""

import json
import sys
from pathlib import Path

try:
    import numpy as np
    import trimesh
    from PIL import Image
    from pxr import Usd, UsdGeom, UsdShade
except ImportError as error:
    print(f"{error.name} is not installed: scripts/test.sh installs it")
    sys.exit(3)


def linear(values):
    """Of sRGB from 0 to 255 (IEC 61966-2-1)."""
    values = np.asarray(values, np.float64) / 255.0
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def described(vertices, faces, material, color, image, uv, properties):
    """faces: (T, 3) corners; uv: of vertices, or None."""
    solid = trimesh.Trimesh(vertices, faces, process=True, merge_norm=True, merge_tex=True)
    picture = None
    if image is not None:
        pixels = linear(np.asarray(image.convert("RGB")))
        middle = uv[faces].mean(axis=1)
        height, width = pixels.shape[:2]
        at = (
            np.clip((1.0 - middle[:, 1]) * height, 0, height - 1),
            np.clip(middle[:, 0] * width, 0, width - 1),
        )
        seen = pixels[at[0].astype(int), at[1].astype(int)]
        picture = {"mean": seen.mean(axis=0).tolist(), "deviation": seen.std(axis=0).tolist()}
    return {
        "material": material,
        "color": list(color)[:3],
        "picture": picture,
        "properties": properties,
        "volume": abs(float(solid.volume)),
        "low": vertices.min(axis=0).tolist(),
        "high": vertices.max(axis=0).tolist(),
    }


def read_gltf(path):
    scene = trimesh.load(path, process=False)
    for name in scene.graph.nodes_geometry:
        matrix, geometry = scene.graph[name]
        mesh = scene.geometry[geometry]
        material = mesh.visual.material
        image, factor = material.baseColorTexture, material.baseColorFactor
        # trimesh has the factor, which is linear in the file, as bytes
        color = np.ones(3) if factor is None else np.asarray(factor, np.float64)[:3] / 255.0
        edge = scene.graph.transforms.edge_data[scene.graph.base_frame, name]
        vertices = trimesh.transform_points(mesh.vertices, matrix)
        uv = None if image is None else mesh.visual.uv
        yield name, described(vertices, mesh.faces, material.name, color, image, uv, edge.get("metadata", {}))


def read_obj(path):
    """trimesh has the parts by material; of which object each is, the lines of the file say."""
    words = [line.split(maxsplit=1) for line in path.read_text(encoding="utf-8").splitlines()]
    objects, current = {}, ""
    for kind, rest in (pair for pair in words if len(pair) == 2):
        if kind == "o":
            current = rest
        elif kind == "usemtl":
            objects[rest] = current
    scene = trimesh.load(path, process=False, group_material=True)
    for mesh in scene.geometry.values():
        material = mesh.visual.material
        image = material.image
        color = np.ones(3) if image is not None else np.asarray(material.diffuse[:3]) / 255.0
        uv = None if image is None else mesh.visual.uv
        name = objects[material.name]
        yield name, described(mesh.vertices, mesh.faces, material.name, color, image, uv, {})


def read_usd(path):
    stage = Usd.Stage.Open(str(path))
    for prim in stage.Traverse():
        if not prim.IsA(UsdGeom.Mesh):
            continue
        mesh, owner = UsdGeom.Mesh(prim), prim.GetParent()
        counts = np.array(mesh.GetFaceVertexCountsAttr().Get())
        corners = np.array(mesh.GetFaceVertexIndicesAttr().Get())
        matrix = np.array(UsdGeom.XformCache().GetLocalToWorldTransform(prim))
        vertices = np.array(mesh.GetPointsAttr().Get()) @ matrix[:3, :3] + matrix[3, :3]
        begin = np.cumsum(counts) - counts
        faces = [[b, b + k, b + k + 1] for b, n in zip(begin, counts, strict=True) for k in range(1, n - 1)]
        uv = UsdGeom.PrimvarsAPI(prim).GetPrimvar("st")  # USD's own name of it
        uv = np.array(uv.ComputeFlattened()) if uv and uv.HasValue() else None
        material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
        shader, _, _ = material.ComputeSurfaceSource()
        given = shader.GetInput("diffuseColor")
        image, color = None, given.Get()
        if given.HasConnectedSource():
            source = UsdShade.Shader(given.GetConnectedSources()[0][0].source.GetPrim())
            image = Image.open(source.GetInput("file").Get().resolvedPath)
            color = (1.0, 1.0, 1.0)
        name = owner.GetAttribute("userProperties:blender:object_name").Get() or owner.GetName()
        own = material.GetPrim().GetAttribute("userProperties:blender:data_name").Get()
        properties = {
            attribute.GetBaseName(): attribute.Get()
            for attribute in owner.GetAttributes()
            if attribute.GetNamespace() == "userProperties"
        }
        yield (
            name,
            described(vertices[corners], np.array(faces), own, color, image, uv, properties),
        )


def main(path):
    reader = {".glb": read_gltf, ".obj": read_obj}.get(path.suffix, read_usd)
    print(json.dumps(dict(reader(path))))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
