# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes as inputs: of a .blend, and of the files that Blender's importers read."""

import base64
import json

import numpy as np
import pytest

LINE = [(0, 0, 0), (2, 0, 0), (2, 0, 3)]


@pytest.fixture
def take(bpy, part):
    """Read a file: its parts, rows of what was left out, and the lines that were said."""
    module = part("fcn_addon.command.blend_file")

    def call(path, **choice):
        said = []
        found, skipped, _ = module.read(str(path), module.Choice(**choice), said.append)
        return found, skipped.groups(), said

    return call


@pytest.fixture
def scene(bpy):
    """A wire, the same wire hidden, and a triangle."""
    for name, edges, faces in (("Wire", [(0, 1), (1, 2)], []), ("Old", [(0, 1)], []), ("Scan", [], [(0, 1, 2)])):
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata(LINE, edges, faces)
        bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, mesh))
    bpy.data.objects["Old"].hide_viewport = True
    return bpy.context.scene


def save(bpy, path):
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return path


def test_what_is_hidden_is_counted_and_can_be_taken(bpy, scene, take, tmp_path):
    path = save(bpy, tmp_path / "a.blend")
    (reading,), skipped, (line,) = take(path)
    assert reading.count == 1 and skipped == {"hidden": ["Old"], "mesh with faces": ["Scan"]}
    assert line.startswith(f"{path}: left out: 1 hidden ('Old'), 1 mesh with faces ('Scan'); --hidden takes")
    (reading,), skipped, _ = take(path, hidden=True)
    assert reading.count == 2 and skipped == {"mesh with faces": ["Scan"]}


def test_what_is_named_is_taken_hidden_or_not(bpy, scene, take, tmp_path):
    path = save(bpy, tmp_path / "a.blend")
    (reading,), skipped, said = take(path, objects=("Old",))
    assert reading.count == 1 and not skipped and not said
    reading, scan = take(path, objects=("Wire", "Scan"))[0]
    assert reading.count == 1 and len(scan.triangles) == 1 and "object 'Scan'" in scan.name


def test_a_scene_with_nothing_says_why(bpy, part, scene, take, tmp_path):
    for name in ("Wire", "Scan"):
        bpy.data.objects[name].hide_viewport = True
    with pytest.raises(part("core.errors").NoCurves, match="shows no curves and no faces .*3 hidden .*--hidden takes"):
        take(save(bpy, tmp_path / "a.blend"))


def test_loose_edges_beside_faces(bpy, take, tmp_path):
    mesh = bpy.data.meshes.new("Both")
    mesh.from_pydata([*LINE, (5, 0, 0), (6, 0, 0), (5, 1, 0)], [(0, 1), (1, 2)], [(3, 4, 5)])
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Both", mesh))
    path = save(bpy, tmp_path / "a.blend")
    (scan,), skipped, (line,) = take(path)
    assert len(scan.triangles) == 1 and "--take-edges takes loose edges" in line
    (reading,), skipped, _ = take(path, take_edges=True)
    assert np.allclose(reading.curves.points, LINE) and skipped == {"faces beside loose edges": ["Both"]}


def test_results_in_a_file_are_no_input(bpy, part, completion, curves, scene, take, tmp_path):
    part("fcn_addon.result.writer").write(completion, curves, source="wall", scene=scene)
    path = save(bpy, tmp_path / "a.blend")
    (reading,), skipped, _ = take(path)
    assert reading.count == 1 and len(skipped["result of an earlier run"]) > 10
    assert take(path, objects=("Input",))[0][0].count == len(curves)


def test_a_missing_library_is_named(bpy, part, scene, take, tmp_path):
    library = save(bpy, tmp_path / "library.blend")
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.objects = ["Wire"]
    bpy.context.scene.collection.objects.link(wanted.objects[0])
    path = save(bpy, tmp_path / "a.blend")
    assert take(path)[0][0].count == 1
    library.unlink()
    with pytest.raises(part("core.errors").InputError, match="the library '.*library.blend' is missing"):
        take(path)


def test_an_image_that_shapes_a_scan_must_be_there_and_no_other(bpy, part, scene, take, tmp_path):
    image = bpy.data.images.new("Height", 4, 4)
    image.filepath_raw, image.file_format = str(tmp_path / "height.png"), "PNG"
    image.save()
    image.source = "FILE"
    image.use_fake_user = True
    path = save(bpy, tmp_path / "a.blend")
    (tmp_path / "height.png").unlink()
    assert take(path, objects=("Scan",))[0]
    texture = bpy.data.textures.new("Height", "IMAGE")
    texture.image = bpy.data.images["Height"]
    bpy.data.objects["Scan"].modifiers.new("Displace", "DISPLACE").texture = texture
    path = save(bpy, tmp_path / "b.blend")
    with pytest.raises(part("core.errors").InputError, match="the image '.*height.png', which a modifier uses"):
        take(path)


def gltf(path, mode, indices, points):
    """A .gltf of one primitive, with its buffer inside."""
    points, indices = np.asarray(points, np.float32), np.asarray(indices, np.uint32)
    data = points.tobytes() + indices.tobytes()
    low, high = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": mode}]}],
        "buffers": [{
            "byteLength": len(data),
            "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode(),
        }],
        "bufferViews": [
            {"buffer": 0, "byteLength": points.nbytes},
            {"buffer": 0, "byteOffset": points.nbytes, "byteLength": indices.nbytes},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3", "min": low, "max": high},
            {"bufferView": 1, "componentType": 5125, "count": len(indices), "type": "SCALAR"},
        ],
    }  # fmt: skip
    path.write_text(json.dumps(document))
    return path


@pytest.mark.parametrize(("mode", "indices"), [(1, [0, 1, 1, 2]), (3, [0, 1, 2])], ids=["lines", "a strip"])
def test_lines_of_gltf_are_curves_with_z_up(take, tmp_path, mode, indices):
    y_up = [(x, z, -y) for x, y, z in LINE]
    (reading,), skipped, _ = take(gltf(tmp_path / "a.gltf", mode, indices, y_up))
    assert not skipped
    assert {tuple(p) for p in reading.curves.points.round(5).tolist()} == {tuple(map(float, p)) for p in LINE}


def test_several_scenes_of_gltf_are_told_or_hidden(bpy, fcn, tmp_path):
    path = gltf(tmp_path / "a.gltf", 3, [0, 1, 2], LINE)
    document = json.loads(path.read_text())
    document["nodes"].append({"mesh": 0, "translation": [9, 0, 0]})
    document["scenes"].append({"nodes": [1]})
    path.write_text(json.dumps(document))
    code, said = fcn(path, "--l0", "5000")
    assert code == 2
    if "2 scenes, and this Blender shows them as one" in said:
        assert "\n2 curves, 6 points" in said and bpy.app.version < (5, 2)
    else:
        assert "\n1 curves, 3 points" in said and "1 hidden" in said


def test_triangles_of_gltf_are_a_scan(take, tmp_path):
    (scan,), _, _ = take(gltf(tmp_path / "a.gltf", 4, [0, 1, 2], [(0, 0, 0), (1, 0, 0), (0, 1, 0)]))
    assert len(scan.triangles) == 1 and scan.points.max() == pytest.approx(1)


WRITERS = {
    ".glb": "export_scene.gltf",
    ".fbx": "export_scene.fbx",
    ".usdc": "wm.usd_export",
    ".abc": "wm.alembic_export",
    ".dae": "wm.collada_export",
}


@pytest.mark.parametrize("ending", WRITERS)
def test_scans_that_blender_writes_come_back_as_they_were(bpy, take, bumps, tmp_path, ending):
    points, triangles = bumps(rows=1, step=1.0)
    mesh = bpy.data.meshes.new("Scan")
    mesh.from_pydata(points.tolist(), [], triangles.tolist())
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Scan", mesh))
    module, _, name = WRITERS[ending].partition(".")
    write = getattr(getattr(bpy.ops, module), name)
    try:
        write.get_rna_type()
    except KeyError:
        pytest.skip(f"this Blender does not write {ending}")
    write(filepath=str(tmp_path / f"a{ending}"))
    (scan,), _, _ = take(tmp_path / f"a{ending}")
    assert len(scan.triangles) == len(triangles)
    assert np.allclose(scan.points.min(axis=0), points.min(axis=0), atol=1e-4)
    assert np.allclose(scan.points.max(axis=0), points.max(axis=0), atol=1e-4)


@pytest.mark.parametrize("ending", [".glb", ".gltf", ".fbx", ".usda", ".usdc", ".abc"])
@pytest.mark.parametrize(
    "content", [b"", b"\x00\xff garbage" * 50, b"glTF\2\0\0\0"], ids=["empty", "garbage", "cut off"]
)
def test_broken_files_are_refused_in_one_line(fcn, tmp_path, ending, content):
    path = tmp_path / f"a{ending}"
    path.write_bytes(content)
    code, said = fcn(path)
    assert (code, said.count("\n")) == (2, 1) and said.startswith(f"error: {path}: ")
    assert "Traceback" not in said and len(said) < 400


def test_objects_of_other_scenes_are_counted_and_can_be_named(bpy, scene, take, tmp_path):
    other = bpy.data.scenes.new("Other")
    other.collection.objects.link(bpy.data.objects["Wire"].copy())
    path = save(bpy, tmp_path / "a.blend")
    (reading,), skipped, _ = take(path)
    assert reading.count == 1 and skipped["in another scene"] == ["Wire.001"]
    assert take(path, objects=("Wire.001",))[0][0].count == 1


def test_text_in_an_instance_is_counted_beside_its_curves(bpy, scene, take, tmp_path):
    home = bpy.data.collections.new("Home")
    home.objects.link(bpy.data.objects["Wire"])
    text = bpy.data.curves.new("Text", "FONT")
    text.body = "Hi"
    home.objects.link(bpy.data.objects.new("Text", text))
    item = bpy.data.objects.new("Instance", None)
    item.instance_type, item.instance_collection = "COLLECTION", home
    scene.collection.objects.link(item)
    (reading,), skipped, _ = take(save(bpy, tmp_path / "a.blend"))
    assert reading.count == 2 and skipped["text"] == ["Instance"]


def test_the_edge_length_of_a_scan_in_a_scene(bpy, scene, fcn, tmp_path):
    for name in ("Wire", "Old"):
        bpy.data.objects.remove(bpy.data.objects[name])
    path = save(bpy, tmp_path / "scan.blend")
    (tmp_path / "in.obj").write_text("v 0 0 0\nv 90 0 0\nl 1 2\n")
    code, said = fcn(tmp_path / "in.obj", "--surface", path, "--l0", "5000")
    assert code == 2 and f"edge length {(2 + 3 + 13**0.5) / 3:.4g} (mean edge of scan.blend)" in said


@pytest.mark.parametrize(
    ("system", "size", "given", "said", "units"),
    [
        ("METRIC", 0.001, "50mm", "edge length 50, 5 cm in the scene (as given)", 4),
        ("METRIC", 0.001, "50", "edge length 50, 5 cm in the scene (as given)", 4),
        ("METRIC", 1.0, "5cm", "edge length 0.05, 5 cm in the scene (as given)", 6),
        ("IMPERIAL", 0.3048, "6 in", 'edge length 0.5, 6" in the scene (as given)', 2),
        ("NONE", 1.0, "0.05", "edge length 0.05 (as given)", 6),
    ],
)
def test_lengths_are_in_the_unit_of_the_scene(bpy, arcs, fcn, tmp_path, system, size, given, said, units):
    ezdxf = pytest.importorskip("ezdxf")
    edge = {"50mm": 50, "50": 50, "5cm": 0.05, "6 in": 0.5, "0.05": 0.05}[given]
    (tmp_path / "in.obj").write_text(arcs())
    bpy.ops.fcn.import_curves(filepath=str(tmp_path / "in.obj"))
    bpy.context.active_object.scale = [10 * edge] * 3
    unit = bpy.context.scene.unit_settings
    unit.system, unit.scale_length = system, size
    path = save(bpy, tmp_path / "a.blend")
    code, text = fcn(path, "--edge-length", given, "--curves", tmp_path / "r.dxf")
    assert code == 0 and said in text
    assert ezdxf.readfile(tmp_path / "r.dxf").units == units


def test_a_unit_needs_inputs_that_have_one(fcn, arcs, tmp_path):
    (tmp_path / "in.obj").write_text(arcs())
    code, text = fcn(tmp_path / "in.obj", "--edge-length", "10cm")
    assert code == 2 and "give the number alone" in text
    code, text = fcn(tmp_path / "in.obj", "--edge-length", "10 parsecs")
    assert code == 2 and "10 parsecs" in text


def test_the_report_names_what_is_left_out(bpy, scene, fcn, tmp_path):
    path = save(bpy, tmp_path / "a.blend")
    code, said = fcn(path, "--object", "Scan", "--detect-only", "--boundary", "--min-length", "0", "--report",
                     tmp_path / "r.json")  # fmt: skip
    assert code == 0, said
    assert json.loads((tmp_path / "r.json").read_text())["left_out"] == []
    code, said = fcn(path, "--hidden", "--l0", "5000")
    assert "left out: 1 mesh with faces ('Scan')" in said
