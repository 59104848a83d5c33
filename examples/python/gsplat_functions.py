"""Hold splatref's projected Gaussians against gsplat's own functions in PyTorch, in float64. No GPU is needed.

    splatref conformance gaussians --preset gsplat -o suite
    python examples/python/gsplat_functions.py suite/gaussians

Prints the largest difference of each number in all scenes, as a multiple of 2^-24, the unit roundoff of float32.
"""

import json
import pathlib
import sys

import numpy as np

RECORD = np.dtype([
    ("place", "<f4", 3), ("key", "<f4"), ("color", "<f4", 3), ("alpha", "<f4"), ("conic", "<f4", 3), ("compensation", "<f4"),
    ("ellipse", "<f4", 3), ("distance", "<f4"), ("unfiltered", "<f4", 3), ("index", "<u4"), ("covariance", "<f4", 6),
    ("center", "<f4", 2), ("bounds", "<u4", 4)])  # fmt: skip


def expected(torch, folder, camera, settings):
    """What gsplat computes for every Gaussian of a scene."""
    from gsplat.cuda import _torch_impl as gsplat

    load = lambda name: torch.from_numpy(np.load(folder / f"{name}.npy").astype(np.float64))  # noqa: E731
    array = lambda values: torch.tensor(values, dtype=torch.float64)  # noqa: E731
    positions, view = load("positions"), array(camera["view_from_world"]["opencv"])
    covariances, _ = gsplat._quat_scale_to_covar_preci(load("rotations")[:, [3, 0, 1, 2]], load("scales"), compute_preci=False)
    K = array([[camera["fx"], 0, camera["cx"]], [0, camera["fy"], camera["cy"]], [0, 0, 1]])
    model = {"perspective": "pinhole", "orthographic": "ortho"}[camera["projection"]]
    _, center, depth, conic, compensation = gsplat._fully_fused_projection(
        positions, covariances, view[None], K[None], camera["width"], camera["height"], settings["low_pass"],
        settings["near_depth"], calc_compensations=True, camera_model=model)  # fmt: skip
    harmonics = load("harmonics").reshape(len(positions), -1, 3)
    degree = min(settings["degree"], int(harmonics.shape[1] ** 0.5) - 1)
    _, covariance = gsplat._world_to_cam(positions, covariances, view[None])
    found = {"place": depth[0], "center": center[0], "conic": conic[0]}
    found["covariance"] = covariance[0].reshape(-1, 9)[:, [0, 1, 2, 4, 5, 8]]
    if settings["compensation"] == "ratio":
        found["compensation"] = compensation[0]
    if model == "pinhole" and settings["color_bounds"] == "zero" and settings["blend"] == "stored":
        eye = torch.tensor(np.float32(camera["eye"]).astype(np.float64))
        color = gsplat._spherical_harmonics(degree, positions - eye, harmonics) + 0.5
        found["color"] = color.clamp_min(0)
    return {name: values.numpy() for name, values in found.items()}


def main(suite):
    try:
        import gsplat  # noqa: F401
        import torch
    except ImportError as missing:
        return print(f"SKIPPED: {missing}")
    worst, scenes = {}, 0
    for path in sorted(pathlib.Path(suite).glob("*/scene.json")):
        scene, folder = json.loads(path.read_text()), path.parent
        if not (folder / "harmonics.npy").exists() or scene["settings"]["clamp"] != "edges":
            continue
        records = np.fromfile(folder / "records.bin", RECORD)
        if not len(records):
            continue
        scenes += 1
        for name, values in expected(torch, folder, scene["camera"], scene["settings"]).items():
            ours = records[name][:, 2] if name == "place" else records[name]
            theirs = values[records["index"]]
            scale = np.abs(theirs).reshape(len(theirs), -1).max(1) if name in ("place", "conic", "covariance") else 1
            if name == "center":
                scale = max(scene["camera"]["width"], scene["camera"]["height"])
            scale = np.maximum(scale, 1e-30)
            error = np.abs(ours - theirs).reshape(len(theirs), -1).max(1) / scale * 2.0**24
            for i, value in enumerate(error):
                if value > worst.get(name, (-1,))[0]:
                    worst[name] = (value, folder.name, int(records["index"][i]))
    print(f"{scenes} scenes; largest differences, in 2^-24:")
    for name, (value, folder, index) in worst.items():
        print(f"  {name:<13}{value:10.2f}  {folder}, splat {index}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("give the folder of a suite")
    main(sys.argv[1])
