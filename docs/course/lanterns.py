#!/usr/bin/env python3
"""Writes a glTF scene for lesson 12: towers at night, lit by lanterns. Their total power does not depend on their number.

    python3 docs/course/lanterns.py 300 scenes/course/paths/lanterns.gltf
"""
import base64, json, random, struct, sys

def main():
    count, path = int(sys.argv[1]), sys.argv[2]
    random.seed(12)
    data, views, accessors = b"", [], []

    def accessor(kind, component, numbers, code, **limits):
        nonlocal data
        packed = struct.pack(f"<{len(numbers)}{code}", *numbers)
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(packed)})
        data += packed + bytes(-len(packed) % 4)
        per_item = 3 if kind == "VEC3" else 1
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "type": kind,
                          "count": len(numbers) // per_item, **limits})
        return len(accessors) - 1

    def shape(corners, faces):
        """The accessors of points and of triangles."""
        sides = list(zip(*corners))
        return {"attributes": {"POSITION": accessor("VEC3", 5126, [x for corner in corners for x in corner], "f",
                                                    min=[min(s) for s in sides], max=[max(s) for s in sides])},
                "indices": accessor("SCALAR", 5123, [i for face in faces for i in face], "H")}

    quad = [(0, 1, 2), (0, 2, 3)]
    floor = shape([(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)], quad)
    box_corners = [(x, y, z) for y in (0, 1) for x, z in ((-1, 1), (1, 1), (1, -1), (-1, -1))]
    box = shape(box_corners, [face for i in range(4) for face in
                              ((i, (i + 1) % 4, (i + 1) % 4 + 4), (i, (i + 1) % 4 + 4, i + 4))]
                + [(4, 5, 6), (4, 6, 7)])
    lantern = shape([(0, -1, 0), (1, 0, 0), (0, 0, 1), (-1, 0, 0), (0, 0, -1), (0, 1, 0)],
                    [f for i in range(4) for f in ((0, i + 1, (i + 1) % 4 + 1), (5, (i + 1) % 4 + 1, i + 1))])

    def dull(*color): return {"pbrMetallicRoughness": {"baseColorFactor": [*color, 1], "metallicFactor": 0},
                              "extensions": {"KHR_materials_specular": {"specularFactor": 0}}}
    materials = [dull(0.5, 0.48, 0.45), dull(0.7, 0.68, 0.64)]
    for color in (1, 0.55, 0.2), (1, 0.3, 0.15), (1, 0.75, 0.4), (0.4, 0.6, 1):
        materials.append({**dull(0, 0, 0), "emissiveFactor": color})
        materials[-1]["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": 10000 / count}}
    shapes = [floor, box] + [lantern] * 4
    nodes = [{"mesh": 0, "scale": [40, 1, 40]}]
    for column in range(-3, 4):  # towers
        for row in range(5):
            nodes.append({"mesh": 1, "translation": [2.4 * column, 0, -2.8 * row],
                          "scale": [0.5, round(random.uniform(0.6, 2.4), 2), 0.5]})
    for _ in range(count):
        x, z = random.uniform(-9, 9), random.uniform(-13, 1.5)
        if abs((x + 1.2) % 2.4 - 1.2) < 0.6: x += 1.2  # beside the towers, not in them
        nodes.append({"mesh": random.choice([2, 2, 3, 4, 5]), "scale": [0.05, 0.05, 0.05],
                      "translation": [round(x, 2), round(random.uniform(0.15, 1.6), 2), round(z, 2)]})
    nodes.append({"camera": 0, "translation": [0, 4.6, 5.6], "rotation": [-0.2588, 0, 0, 0.9659]})  # 30 degrees down
    used = ["KHR_materials_specular", "KHR_materials_emissive_strength"]
    scene = {"asset": {"version": "2.0"}, "extensionsUsed": used, "scene": 0, "nodes": nodes,
             "scenes": [{"nodes": list(range(len(nodes)))}], "materials": materials,
             "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1, "aspectRatio": 1.5}}],
             "meshes": [{"primitives": [{**shape, "material": i}]} for i, shape in enumerate(shapes)],
             "accessors": accessors, "bufferViews": views,
             "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64,"
                          + base64.b64encode(data).decode()}]}
    with open(path, "w", encoding="utf-8") as file:
        json.dump(scene, file, separators=(",", ":"))

if __name__ == "__main__":
    main()
