"""Every way in which a scene can be wrong: file, line, column, path, what was found, what is expected, what may have been meant."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from lumiere.bsdf import MATERIALS
from lumiere.camera import CAMERAS
from lumiere.errors import SceneError
from lumiere.filter import FILTERS
from lumiere.light import LIGHTS
from lumiere.scene.load import load
from lumiere.scene.unsupported import UNSUPPORTED
from lumiere.shape import SHAPES
from lumiere.texture import TEXTURES

CASES = {  # text with § in front of the culprit → path, complaint (whole, or its beginning where it ends in …)
    # The document
    "no scene": ("§{}", "", "found no 'scene', expected {\"scene\": {…}}"),
    "not an object": ("§[1, 2]", "", 'found [1, 2], expected {"scene": {…}}'),
    "misspelt scene": ('{§"scen": {}}', "scen", "found an unknown key, expected one of: scene; did you mean 'scene'?"),
    "scene is a list": ('{"scene": §[]}', "scene", "found an empty list, expected an object"),
    "scene is null": ('{"scene": §null}', "scene", "found null, expected an object"),
    "unknown section": ('{"scene": {§"camra": {}}}', "scene.camra", "found an unknown key, expected one of: camera, film, integrator, sampler, "
                        "materials, textures, media, geometry, lights; did you mean 'camera'?"),
    "nothing alike": ('{"scene": {§"xyz": {}}}', "scene.xyz", "found an unknown key, expected one of: camera, film, integrator, sampler, "
                      "materials, textures, media, geometry, lights"),
    "odd key": ('{"scene": {§"a b": {}}}', 'scene["a b"]', "found an unknown key, expected one of…"),
    "geometry is an object": ('{"scene": {"geometry": §{}}}', "scene.geometry", "found an object, expected a list"),
    "materials is a list": ('{"scene": {"materials": §[{}], "textures": {"t": {"type": "constant"}}}}', "scene.materials",
                            "found a list of 1, expected an object"),
    "media is a list": ('{"scene": {"media": §[1]}}', "scene.media", "not supported yet: media"),
    "media is an empty list": ('{"scene": {"media": §[]}}', "scene.media", "found an empty list, expected an object"),
    "repeated section": ('{"scene": {"film": {},\n §"film": {}}}', "scene.film",
                         "found a repeated key (first on line 1), expected each key once"),
    # Numbers
    "integer too small": ('{"scene": {"film": {"width": §0}}}', "scene.film.width", "found 0, expected an integer in [1, 65536]"),
    "integer too large": ('{"scene": {"film": {"height": §65537}}}', "scene.film.height", "found 65537, expected an integer in [1, 65536]"),
    "integer with a fraction": ('{"scene": {"film": {"width": §1.5}}}', "scene.film.width", "found 1.5, expected an integer in [1, 65536]"),
    "integer as a string": ('{"scene": {"film": {"width": §"512"}}}', "scene.film.width", 'found "512", expected an integer in [1, 65536]'),
    "integer as a boolean": ('{"scene": {"film": {"width": §true}}}', "scene.film.width", "found true, expected an integer in [1, 65536]"),
    "seed": ('{"scene": {"sampler": {"seed": §4294967296}}}', "scene.sampler.seed", "found 4294967296, expected an integer in [0, 4294967295]"),
    "negative seed": ('{"scene": {"sampler": {"seed": §-1}}}', "scene.sampler.seed", "found -1, expected an integer in [0, 4294967295]"),
    "no sample": ('{"scene": {"sampler": {"spp": §0}}}', "scene.sampler.spp", "found 0, expected an integer in [1, 2147483647]"),
    "depth": ('{"scene": {"integrator": {"max_depth": §65536}}}', "scene.integrator.max_depth",
              "found 65536, expected an integer in [0, 65535]"),
    "nullable integer": ('{"scene": {"integrator": {"russian_roulette_depth": §"never"}}}', "scene.integrator.russian_roulette_depth",
                         'found "never", expected an integer in [0, 65535] or null'),
    "null": ('{"scene": {"integrator": {"max_depth": §null}}}', "scene.integrator.max_depth",
             "found null, expected an integer in [0, 65535]"),
    "number is a boolean": ('{"scene": {"camera": {"fov": §true}}}', "scene.camera.fov", "found true, expected a number in (0, 180)"),
    "at an open bound": ('{"scene": {"camera": {"fov": §180}}}', "scene.camera.fov", "found 180, expected a number in (0, 180)"),
    "rounds to an open bound": ('{"scene": {"camera": {"fov": §179.999999999}}}', "scene.camera.fov",
                                "found 179.999999999, expected a number in (0, 180)"),
    "rounds to zero": ('{"scene": {"geometry": [{"type": "sphere", "radius": §1e-60}]}}', "scene.geometry[0].radius",
                       "found 1e-60, expected a number > 0"),
    "infinite": ('{"scene": {"camera": {"fov": §1e999}}}', "scene.camera.fov", "found Infinity, expected a finite number"),
    "beyond single precision": ('{"scene": {"geometry": [{"type": "sphere", "radius": §1e39}]}}', "scene.geometry[0].radius",
                                "found 1e+39, expected a number that single precision holds (at most 3.403e+38)"),
    "huge integer": ('{"scene": {"film": {"width": §1' + "0" * 350 + "}}}", "scene.film.width",
                     "found an integer of 1163 bits, expected an integer in [1, 65536]"),
    # Vectors
    "short vector": ('{"scene": {"camera": {"position": §[1, 2]}}}', "scene.camera.position", "found [1, 2], expected a list of 3 numbers"),
    "long vector": ('{"scene": {"camera": {"position": §[1, 2, 3, 4, 5]}}}', "scene.camera.position",
                    "found a list of 5, expected a list of 3 numbers"),
    "vector is a number": ('{"scene": {"camera": {"position": §1}}}', "scene.camera.position", "found 1, expected a list of 3 numbers"),
    "not a number": ('{"scene": {"camera": {"position": [1, §"2", 3]}}}', "scene.camera.position[1]", 'found "2", expected a number'),
    "infinite in a vector": ('{"scene": {"camera": {"position": [1,\n2, §-1e400]}}}', "scene.camera.position[2]",
                             "found -Infinity, expected a finite number"),
    "list in a vector": ('{"scene": {"camera": {"position": [§[1], [2], [3]]}}}', "scene.camera.position[0]", "found [1], expected a number"),
    "crop outside": ('{"scene": {"film": §{"crop": [0, 0, 513, 1]}}}', "scene.film", "found the crop [0, 0, 513, 1], expected [x0, y0, x1, y1] "
                     "with x0 < x1 and y0 < y1 inside the film of 512 × 512 pixels"),
    "empty crop": ('{"scene": {"film": §{"crop": [5, 0, 5, 1]}}}', "scene.film", "found the crop [5, 0, 5, 1], expected…"),
    "negative crop": ('{"scene": {"film": {"crop": [§-1, 0, 5, 1]}}}', "scene.film.crop[0]", "found -1, expected an integer in [0, 65536]"),
    "fraction in the crop": ('{"scene": {"film": {"crop": [0, 0, §5.5, 1]}}}', "scene.film.crop[2]",
                             "found 5.5, expected an integer in [0, 65536]"),
    # Choices
    "choice": ('{"scene": {"film": {"tonemap": §"acse"}}}', "scene.film.tonemap",
               "found \"acse\", expected one of: none, aces, agx, filmic; did you mean 'aces'?"),
    "choice is a number": ('{"scene": {"film": {"tonemap": §1}}}', "scene.film.tonemap", "found 1, expected one of: none, aces, agx, filmic"),
    "unknown layer": ('{"scene": {"film": {"aovs": ["depth", §"normals"]}}}', "scene.film.aovs[1]", "found \"normals\", expected one of: albedo, "
                      "normal, depth, position, uv, material_id, object_id, sample_count, variance, direct, indirect, emission; "
                      "did you mean 'normal'?"),
    "layer twice": ('{"scene": {"film": {"aovs": ["depth", §"depth"]}}}', "scene.film.aovs[1]",
                    'found "depth" a second time, expected each once'),
    "one layer, no list": ('{"scene": {"film": {"aovs": §"depth"}}}', "scene.film.aovs", 'found "depth", expected a list of some of: albedo, …'),
    "boolean": ('{"scene": {"geometry": [{"type": "sphere", "visible": {"camera": §1}}]}}', "scene.geometry[0].visible.camera",
                "found 1, expected true or false"),
    "string": ('{"scene": {"geometry": [{"type": "sphere", "name": §1}]}}', "scene.geometry[0].name", "found 1, expected a string"),
    "nested object": ('{"scene": {"geometry": [{"type": "sphere", "visible": §false}]}}', "scene.geometry[0].visible",
                      "found false, expected an object"),
    "key of a nested object": ('{"scene": {"geometry": [{"type": "sphere", "visible": {§"shadows": false}}]}}',
                               "scene.geometry[0].visible.shadows",
                               "found an unknown key, expected one of: camera, shadow; did you mean 'shadow'?"),
    # Types
    "unknown camera": ('{"scene": {"camera": {"type": §"fish_eye"}}}', "scene.camera.type", "found \"fish_eye\", expected one of: fisheye, "
                       "orthographic, panorama, perspective, thin_lens; did you mean 'fisheye'?"),
    "key of another camera": ('{"scene": {"camera": {§"aperture_radius": 1}}}', "scene.camera.aperture_radius",
                              "found an unknown key, expected one of: type, position, look_at, up, transform, fov, fov_axis"),
    "camera is a string": ('{"scene": {"camera": §"perspective"}}', "scene.camera", 'found "perspective", expected an object with a type'),
    "unknown filter": ('{"scene": {"film": {"filter": {"type": §"bx"}}}}', "scene.film.filter.type", "found \"bx\", expected one of: "
                       "blackman_harris, box, gaussian, mitchell, tent; did you mean 'box'?"),
    "no type": ('{"scene": {"geometry": [§{"radius": 1}]}}', "scene.geometry[0]", "found no 'type', expected one of: box, disk, mesh, …"),
    "type is a number": ('{"scene": {"geometry": [{"type": §1}]}}', "scene.geometry[0].type", "found 1, expected one of: box, disk, mesh, …"),
    "unknown shape": ('{"scene": {"geometry": [{"type": "sphere"}, {"type": §"spehre"}]}}', "scene.geometry[1].type",
                      "found \"spehre\", expected one of: box, disk, mesh, plane, rectangle, sphere; did you mean 'sphere'?"),
    "unknown light": ('{"scene": {"lights": [{"type": §"sun"}]}}', "scene.lights[0].type",
                      'found "sun", expected one of: area, directional, environment, point, spot'),
    "unknown integrator": ('{"scene": {"integrator": {"type": §"paths"}}}', "scene.integrator.type",
                           "found \"paths\", expected one of: path, bdpt, direct, ambient_occlusion; did you mean 'path'?"),
    "shape is a string": ('{"scene": {"geometry": [§"sphere"]}}', "scene.geometry[0]", 'found "sphere", expected an object with a type'),
    "unknown material": ('{"scene": {"materials": {"wood": {"type": §"lambrt"}}}}', "scene.materials.wood.type",
                         "found \"lambrt\", expected one of…"),
    "unknown texture": ('{"scene": {"textures": {"wood": {"type": §"picture"}}}}', "scene.textures.wood.type",
                        'found "picture", expected one of: checker, constant, image, vertex_color'),
    # Spectra and textures
    "material's range": ('{"scene": {"materials": {"wood": {"type": "oren_nayar", "roughness": §1.5}}}}', "scene.materials.wood.roughness",
                         "found 1.5, expected a number in [0, 1] or a texture"),
    "material's key": ('{"scene": {"materials": {"wood": {"type": "oren_nayar", §"roughnes": 0.5}}}}', "scene.materials.wood.roughnes",
                       "found an unknown key, expected one of: …; did you mean 'roughness'?"),
    "colour": ('{"scene": {"materials": {"m": {"type": "lambert", "albedo": §"#12345"}}}}', "scene.materials.m.albedo",
               'found "#12345", expected a spectrum (a number, [r, g, b] or "#rrggbb") in [0, 1] or a texture'),
    "colour's range": ('{"scene": {"materials": {"m": {"type": "lambert", "albedo": [0.5, §1.1, 0]}}}}', "scene.materials.m.albedo[1]",
                       "found 1.1, expected a number in [0, 1]"),
    "grey's range": ('{"scene": {"lights": [{"type": "point", "intensity": §-1}]}}', "scene.lights[0].intensity",
                     'found -1, expected a spectrum (a number, [r, g, b] or "#rrggbb") >= 0'),
    "two channels": ('{"scene": {"lights": [{"type": "point", "intensity": §[1, 1]}]}}', "scene.lights[0].intensity",
                     'found [1, 1], expected a spectrum (a number, [r, g, b] or "#rrggbb") >= 0'),
    "no texture allowed": ('{"scene": {"lights": [{"type": "point", "intensity": §{"texture": "t"}}]}}', "scene.lights[0].intensity",
                           'found an object, expected a spectrum (a number, [r, g, b] or "#rrggbb") >= 0'),
    "dangling texture": ('{"scene": {"textures": {"wood": {"type": "constant"}}, "materials": {"m": {"type": "lambert", "albedo": '
                         '{"texture": §"woood"}}}}}', "scene.materials.m.albedo.texture",
                         "found \"woood\", expected the name of a texture, one of: wood; did you mean 'wood'?"),
    "texture's name": ('{"scene": {"materials": {"m": {"type": "lambert", "albedo": {"texture": §1}}}}}', "scene.materials.m.albedo.texture",
                       "found 1, expected the name of a texture"),
    "key beside texture": ('{"scene": {"textures": {"t": {"type": "constant"}}, "materials": {"m": {"type": "lambert", "albedo": '
                           '{"texture": "t", §"scale": 2}}}}}', "scene.materials.m.albedo.scale",
                           'found a key beside \'texture\', expected {"texture": "NAME"} alone'),
    "neither texture nor type": ('{"scene": {"materials": {"m": {"type": "lambert", "albedo": §{"file": "x.png"}}}}}', "scene.materials.m.albedo",
                                 "found an object with neither 'texture' nor 'type', expected…"),
    "texture by its bare name": ('{"scene": {"materials": {"m": {"type": "lambert", "bump_map": §"t"}}}}', "scene.materials.m.bump_map",
                                 'found "t", expected a texture ({"texture": "NAME"} or an object with a type)'),
    "inline texture's key": ('{"scene": {"materials": {"m": {"type": "lambert", "albedo": {"type": "checker", §"c": 1}}}}}',
                             "scene.materials.m.albedo.c", "found an unknown key, expected one of: type, a, b, scale"),
    "unused texture": ('{"scene": {"textures": {"t": {"type": "constant", "value": §-1}}}}', "scene.textures.t.value", "found -1, expected…"),
    # Materials of shapes
    "dangling material": ('{"scene": {"materials": {"wood": {"type": "lambert"}, "glass": {"type": "lambert"}}, "geometry": '
                          '[{"type": "sphere",\n\t"material": §"glas"}]}}', "scene.geometry[0].material",
                          "found \"glas\", expected the name of a material, one of: wood, glass; did you mean 'glass'?"),
    "no materials": ('{"scene": {"geometry": [{"type": "sphere", "material": §"wood"}]}}', "scene.geometry[0].material",
                     'found "wood", expected the name of a material, but the scene has none'),
    "material is a number": ('{"scene": {"geometry": [{"type": "sphere", "material": §1}]}}', "scene.geometry[0].material",
                             "found 1, expected a material (a name or an object with a type)"),
    "inline material": ('{"scene": {"geometry": [{"type": "sphere", "material": {"type": "lambert", "albedo": §2}}]}}',
                        "scene.geometry[0].material.albedo", "found 2, expected a spectrum…"),
    "unused material": ('{"scene": {"materials": {"m": {"type": "lambert", "albedo": §2}}}}', "scene.materials.m.albedo",
                        "found 2, expected a spectrum…"),
    "name inside a named material": ('{"scene": {"materials": {"m": {"type": "lambert", §"name": "n"}}}}', "scene.materials.m.name",
                                     "found an unknown key, expected one of…"),
    # Files
    "missing file": ('{"scene": {"geometry": [{"type": "mesh", "file": §"cow.ply"}]}}', "scene.geometry[0].file",
                     "found \"cow.ply\", which does not exist in FOLDER, expected a file; did you mean 'crow.ply'?"),
    "folder": ('{"scene": {"geometry": [{"type": "mesh", "file": §".."}]}}', "scene.geometry[0].file",
               'found "..", which is a directory in FOLDER, expected a file'),
    "no name": ('{"scene": {"geometry": [{"type": "mesh", "file": §""}]}}', "scene.geometry[0].file", 'found "", expected a file\'s name'),
    "NUL in a name": ('{"scene": {"geometry": [{"type": "mesh", "file": §"a\\u0000"}]}}', "scene.geometry[0].file", 'found "a\\u0000", which …'),
    "long name": ('{"scene": {"geometry": [{"type": "mesh", "file": §"' + "a" * 5000 + '"}]}}', "scene.geometry[0].file",
                  f'found "{"a" * 60}…", which cannot be a file in FOLDER, expected a file'),
    # Arrays
    "array is a string": ('{"scene": {"geometry": [{"type": "mesh", "vertices": §"x"}]}}', "scene.geometry[0].vertices",
                          'found "x", expected a list of numbers, 3 a row'),
    "short row": ('{"scene": {"geometry": [{"type": "mesh", "vertices": [[1, 2, 3], §[1, 2]]}]}}', "scene.geometry[0].vertices[1]",
                  "found [1, 2], expected a list of 3 numbers"),
    "rows of two": ('{"scene": {"geometry": [{"type": "mesh", "vertices": [§[1, 2], [1, 2]]}]}}', "scene.geometry[0].vertices[0]",
                    "found [1, 2], expected a list of 3 numbers"),
    "odd count": ('{"scene": {"geometry": [{"type": "mesh", "vertices": §[1, 2, 3, 4]}]}}', "scene.geometry[0].vertices",
                  "found 4 numbers, expected a list of numbers, 3 a row"),
    "string in a row": ('{"scene": {"geometry": [{"type": "mesh", "vertices": [[1, 2, 3], [1, §"2", 3]]}]}}', "scene.geometry[0].vertices[1][1]",
                        'found "2", expected a number'),
    "string in a list": ('{"scene": {"geometry": [{"type": "mesh", "vertices": [1, §null, 3]}]}}', "scene.geometry[0].vertices[1]",
                         "found null, expected a number"),
    "number among rows": ('{"scene": {"geometry": [{"type": "mesh", "vertices": [[1, 2, 3], §4]}]}}', "scene.geometry[0].vertices[1]",
                          "found 4, expected a list of 3 numbers"),
    "infinite in a row": ('{"scene": {"geometry": [{"type": "mesh", "vertices": [[1, 2, 3], [4, 5, §1e999]]}]}}',
                          "scene.geometry[0].vertices[1][2]", "found Infinity, expected a finite number"),
    "infinite in a list": ('{"scene": {"geometry": [{"type": "mesh", "vertices": [1, 2, §1e39]}]}}', "scene.geometry[0].vertices[2]",
                           "found 1e+39, expected a number that single precision holds (at most 3.403e+38)"),
    "fraction in indices": ('{"scene": {"geometry": [{"type": "mesh", "vertices": [], "faces": [[0, 1, 2], [0, §1.5, 2]]}]}}',
                            "scene.geometry[0].faces[1][1]", "found 1.5, expected an integer"),
    "huge index": ('{"scene": {"geometry": [{"type": "mesh", "vertices": [], "faces": [0, 1, §18446744073709551616]}]}}',
                   "scene.geometry[0].faces[2]", "found 18446744073709551616, expected an integer"),
    "unsigned index": ('{"scene": {"geometry": [{"type": "mesh", "vertices": [], "faces": [0, 1, §9223372036854775808]}]}}',
                       "scene.geometry[0].faces[2]", "found 9223372036854775808, expected an integer"),
    # Transforms
    "transform is an object": ('{"scene": {"geometry": [{"type": "box", "transform": §{"scale": 2}}]}}', "scene.geometry[0].transform",
                               "found an object, expected a list of steps (objects with one of: translate, rotate, scale, look_at, matrix)"),
    "unknown step": ('{"scene": {"geometry": [{"type": "box", "transform": [{§"translation": [1, 2, 3]}]}]}}',
                     "scene.geometry[0].transform[0].translation",
                     "found an unknown key, expected one of: translate, rotate, scale, look_at, matrix; did you mean 'translate'?"),
    "step is a number": ('{"scene": {"geometry": [{"type": "box", "transform": [§1]}]}}', "scene.geometry[0].transform[0]",
                         "found 1, expected an object"),
    "two steps in one": ('{"scene": {"geometry": [{"type": "box", "transform": [§{"scale": 2, "translate": [1, 2, 3]}]}]}}',
                         "scene.geometry[0].transform[0]",
                         "found translate and scale, expected exactly one of: translate, rotate, scale, look_at, matrix"),
    "empty step": ('{"scene": {"geometry": [{"type": "box", "transform": [§{}]}]}}', "scene.geometry[0].transform[0]",
                   "found an empty step, expected exactly one of: translate, rotate, scale, look_at, matrix"),
    "no axis": ('{"scene": {"geometry": [{"type": "box", "transform": [{"rotate": {"axis": [0, 0, 0], "angle": 1}}]}]}}'.replace('{"axis', '§{"axis'),
                "scene.geometry[0].transform[0].rotate", "found the axis [0, 0, 0], expected a direction"),
    "angle missing": ('{"scene": {"geometry": [{"type": "box", "transform": [{"rotate": §{"axis": [0, 0, 1]}}]}]}}',
                      "scene.geometry[0].transform[0].rotate", "found no 'angle', expected a number"),
    "flat scale": ('{"scene": {"geometry": [{"type": "box", "transform": [§{"scale": [1, 0, 1]}]}]}}', "scene.geometry[0].transform[0]",
                   "found a step that flattens space, expected one that can be inverted"),
    "no scale": ('{"scene": {"geometry": [{"type": "box", "transform": [§{"scale": 0}]}]}}', "scene.geometry[0].transform[0]",
                 "found a step that flattens space, expected one that can be inverted"),
    "scale of two": ('{"scene": {"geometry": [{"type": "box", "transform": [{"scale": §[1, 2]}]}]}}', "scene.geometry[0].transform[0].scale",
                     "found [1, 2], expected a list of 3 numbers or a single number"),
    "singular matrix": ('{"scene": {"geometry": [{"type": "box", "transform": [§{"matrix": [1,2,3,0, 4,5,6,0, 7,8,9,0, 0,0,0,1]}]}]}}',
                        "scene.geometry[0].transform[0]", "found a step that flattens space, expected one that can be inverted"),
    "projective matrix": ('{"scene": {"geometry": [{"type": "box", "transform": [§{"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,1,1]}]}]}}',
                          "scene.geometry[0].transform[0]", "found the last row [0.0, 0.0, 1.0, 1.0], expected [0, 0, 0, 1]: …"),
    "matrix of nine": ('{"scene": {"geometry": [{"type": "box", "transform": [{"matrix": §[1,0,0, 0,1,0, 0,0,1]}]}]}}',
                       "scene.geometry[0].transform[0].matrix", "found a list of 9, expected a list of 16 numbers"),
    "nowhere to look": ('{"scene": {"geometry": [{"type": "box", "transform": [{"look_at": §{"origin": [1, 2, 3], "target": [1, 2, 3]}}]}]}}',
                        "scene.geometry[0].transform[0].look_at", "found equal points, or an up along the line of sight, expected…"),
    "up ahead": ('{"scene": {"geometry": [{"type": "box", "transform": [{"look_at": §{"origin": [0, 0, 0], "target": [0, 5, 0]}}]}]}}',
                 "scene.geometry[0].transform[0].look_at", "found equal points, or an up along the line of sight, expected…"),
    "steps that overflow": ('{"scene": {"geometry": [{"type": "box", "transform": §[{"scale": 1e30}, {"scale": 1e30}]}]}}',
                            "scene.geometry[0].transform", "found steps that together flatten space or leave single precision's range, …"),
    "steps that vanish": ('{"scene": {"geometry": [{"type": "box", "transform": §[' + '{"scale": 1e-30}, ' * 9 + "]}]}}",
                          "scene.geometry[0].transform", "found steps that together flatten space or leave single precision's range, …"),
    # What objects say about themselves
    "camera looks at itself": ('{"scene": {"camera": §{"position": [1, 2, 3], "look_at": [1, 2, 3]}}}', "scene.camera", "found look_at equal to …"),
    "no direction": ('{"scene": {"lights": [§{"type": "directional", "direction": [0, 0, 0]}]}}', "scene.lights[0]", "found the direction …"),
    "no picture": ('{"scene": {"textures": {"t": §{"type": "image"}}}}', "scene.textures.t", "found no file, expected …"),
    "box inside out": ('{"scene": {"geometry": [§{"type": "box", "min": [1, 1, 1], "max": [0, 0, 0]}]}}', "scene.geometry[0]", "found min …"),
    "a conductor too many": ('{"scene": {"materials": {"m": §{"type": "conductor", "metal": "gold", "eta": 1, "k": 1}}}}', "scene.materials.m",
                             "found …"),
    # What is to come
    "bdpt": ('{"scene": {"integrator": {"type": §"bdpt"}}}', "scene.integrator.type", "not supported yet: bdpt"),
    "media": ('{"scene": {"media": §{"fog": {"type": "homogeneous"}}}}', "scene.media", "not supported yet: media"),
    "interior": ('{"scene": {"materials": {"m": {"type": "dielectric", "interior": §"fog"}}}}', "scene.materials.m.interior",
                 "not supported yet: interior"),
    "null material": ('{"scene": {"materials": {"m": {"type": §"null"}}}}', "scene.materials.m.type", "not supported yet: null"),
    "group": ('{"scene": {"geometry": [{"type": §"group"}]}}', "scene.geometry[0].type", "not supported yet: group"),
    "instance": ('{"scene": {"geometry": [{"type": §"instance"}]}}', "scene.geometry[0].type", "not supported yet: instance"),
    "shutter": ('{"scene": {"camera": {"shutter": §[0, 1]}}}', "scene.camera.shutter", "not supported yet: shutter"),
}


@pytest.mark.parametrize(("marked", "path", "words"), CASES.values(), ids=CASES)
def test_complaint(tmp_path: Path, marked: str, path: str, words: str) -> None:
    (tmp_path / "crow.ply").touch()
    scene = tmp_path / "s.json"
    scene.write_text(marked.replace("§", ""), encoding="utf-8")
    before = marked[: marked.index("§")]
    line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
    with pytest.raises(SceneError) as caught:
        load(scene)
    text = str(caught.value)
    assert len(text.splitlines()) == 1
    assert caught.value.exit_status == 2
    expected = f"{scene}:{line}:{column}: {path}: {words.replace('FOLDER', str(tmp_path))}".replace(": : ", ": ")
    beginning, dots, end = expected.partition("…") if "a" * 60 not in words and "{…}" not in words else (expected, "", "")
    if dots:
        assert text.startswith(beginning)
        assert text.endswith(end)
    else:
        assert text == expected


def test_what_is_not_supported_is_tested() -> None:
    """The table and the cases above say the same; nothing in the table is already a kind that could be used."""
    tested = {words.removeprefix("not supported yet: ") for _, _, words in CASES.values() if words.startswith("not supported yet: ")}
    assert {name for (_, key), names in UNSUPPORTED.items() for name in names or {key}} == tested
    for registry in (MATERIALS, CAMERAS, FILTERS, LIGHTS, SHAPES, TEXTURES):
        assert not UNSUPPORTED.get((registry.noun, "type"), frozenset()) & set(registry.kinds())


@pytest.mark.parametrize("empty", ['"media": {}', '"sampler": {"adaptive": null}', '"camera": {"shutter": null}'])
def test_an_empty_key_asks_for_nothing(tmp_path: Path, empty: str) -> None:
    (tmp_path / "s.json").write_text(f'{{"scene": {{{empty}}}}}')
    load(tmp_path / "s.json")


@pytest.mark.parametrize(("document", "complaint"), [
    ({}, "the scene: found no 'scene', expected {\"scene\": {…}}"),
    ({"scene": {"film": {"width": 0}}}, "scene.film.width: found 0, expected an integer in [1, 65536]"),
    ({"scene": {"camera": {"fov": math.nan}}}, "scene.camera.fov: found NaN, expected a finite number"),
    ({"scene": {"camera": {"position": np.array([0.0, np.inf, 1.0])}}}, "scene.camera.position[1]: found Infinity, expected a finite number"),
    ({"scene": {"camera": {"position": [0.0, -math.inf, 1.0]}}}, "scene.camera.position[1]: found -Infinity, expected a finite number"),
    ({"scene": {"film": {"width": 10**10000}}}, "scene.film.width: found an integer of 33220 bits, expected an integer in [1, 65536]"),
    ({"scene": {"film": {"width": np.True_}}}, "scene.film.width: found true, expected an integer in [1, 65536]"),
    ({"scene": {"film": {"aovs": {"depth"}}}}, "scene.film.aovs: found a Python set, expected what JSON can hold"),
    ({"scene": {"film": {1: 2}}}, "scene.film: found a key that is a int, expected strings"),
    ({"scene": {"geometry": [{"type": "mesh", "vertices": np.zeros((2, 2)), "faces": [0, 1, 2]}]}},
     "scene.geometry[0].vertices[0]: found [0.0, 0.0], expected a list of 3 numbers"),
    ({"scene": {"geometry": [{"type": "mesh", "vertices": np.array([[0, 0, 0], [0, np.nan, 0]]), "faces": [0, 1, 2]}]}},
     "scene.geometry[0].vertices[1][1]: found NaN, expected a finite number"),
    ({"scene": {"geometry": [{"type": "mesh", "file": "no\ud800where"}]}}, "scene.geometry[0].file: found \"no\\ud800where\", which "),
])
def test_complaint_about_a_dict(document: dict, complaint: str) -> None:
    with pytest.raises(SceneError) as caught:
        load(document)
    assert str(caught.value).startswith(complaint)
    str(caught.value).encode()


def test_a_dict_inside_itself() -> None:
    document: dict = {}
    document["scene"] = document
    with pytest.raises(SceneError, match="nested deeper than"):
        load(document)


@pytest.mark.parametrize(("name", "complaint"), [
    ("none.json", ": found no such file, expected a scene"),
    (".", ": found a directory, expected a scene file"),
    ("s.json/t.json", ": cannot be read (Not a directory), expected a scene file"),
    ("\0", ": cannot be read (embedded null byte), expected a scene file"),
    ("a" * 5000, ": cannot be read (File name too long), expected a scene file"),
])
def test_no_scene_file(tmp_path: Path, name: str, complaint: str) -> None:
    (tmp_path / "s.json").write_text("{}")
    with pytest.raises(SceneError) as caught:
        load(tmp_path / name)
    assert str(caught.value).endswith(complaint)
    assert len(str(caught.value).splitlines()) == 1
