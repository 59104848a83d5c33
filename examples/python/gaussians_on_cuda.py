"""Draw the suite of `gaussians` with a CUDA program, and get a verdict on each picture.

    splatref conformance gaussians --preset gsplat -o suite
    python examples/python/gaussians_on_cuda.py gsplat suite/gaussians
    for scene in suite/gaussians/*/; do splatref verify $scene/scene.toml $scene/gsplat/client.toml; done

`gsplat` is the package of this name; `inria` is diff_gaussian_rasterization, the original program; `mip` is
the package of that name in Mip-Splatting; `2dgs` is diff_surfel_rasterization. Install them as their pages say. Each draws with its own rules, so write the suite with its preset.
"""

import importlib
import json
import pathlib
import sys

import numpy as np


def inria(torch, scene, camera, settings, package="diff_gaussian_rasterization", **more):
    """The blended colours alone: the program returns no other plane."""
    package = importlib.import_module(package)
    (w, h), (fx, fy, cx, cy) = ([camera[k] for k in keys] for keys in (("width", "height"), ("fx", "fy", "cx", "cy")))
    near, far = 0.01, 100.0
    clip = np.array([[2 * fx / w, 0, 2 * cx / w - 1, 0], [0, 2 * fy / h, 2 * cy / h - 1, 0],
                     [0, 0, far / (far - near), -far * near / (far - near)], [0, 0, 1, 0]])  # fmt: skip
    tensor = lambda values: torch.tensor(np.array(values, np.float32, order="C"), device="cuda")  # noqa: E731
    view = np.array(camera["view_from_world"]["opencv"])
    rules = package.GaussianRasterizationSettings(
        image_height=h, image_width=w, tanfovx=w / (2 * fx), tanfovy=h / (2 * fy), bg=tensor([0, 0, 0]), scale_modifier=1.0,
        viewmatrix=tensor(view.T), projmatrix=tensor((clip @ view).T), sh_degree=settings["degree"],
        campos=tensor(camera["eye"]), prefiltered=False, debug=False, **more)  # fmt: skip
    names = {"positions": "means3D", "scales": "scales", "rotations": "rotations", "harmonics": "shs"}
    arrays = {names[name]: scene[name] for name in names} | {"opacities": scene["opacities"][:, None]}
    color = package.GaussianRasterizer(rules)(means2D=torch.zeros_like(arrays["means3D"]), **arrays)[0]
    return {"blended": color.permute(1, 2, 0)}


def mip(torch, scene, camera, settings):
    """The original program with another filter."""
    offset = torch.zeros(camera["height"], camera["width"], 2, device="cuda")
    return inria(torch, scene, camera, settings, kernel_size=settings["low_pass"], subpixel_offset=offset)


def surfels(torch, scene, camera, settings):
    """2D Gaussians: the first two scales."""
    scene = scene | {"scales": scene["scales"][:, :2].contiguous()}
    return inria(torch, scene, camera, settings, "diff_surfel_rasterization")


def gsplat(torch, scene, camera, settings):
    """Colours, opacity and the expected depth."""
    from gsplat import rasterization

    tensor = lambda values: torch.tensor(np.asarray(values, np.float32), device="cuda")[None]  # noqa: E731
    K = tensor([[camera["fx"], 0, camera["cx"]], [0, camera["fy"], camera["cy"]], [0, 0, 1]])
    color, alpha, _ = rasterization(
        scene["positions"], scene["rotations"], scene["scales"], scene["opacities"], scene["harmonics"],
        tensor(camera["view_from_world"]["opencv"]), K, camera["width"], camera["height"], sh_degree=settings["degree"],
        near_plane=settings["near_depth"], eps2d=settings["low_pass"], packed=False, render_mode="RGB+ED",
        rasterize_mode={"none": "classic", "ratio": "antialiased"}[settings["compensation"]],
        camera_model={"perspective": "pinhole", "orthographic": "ortho"}[camera["projection"]])  # fmt: skip
    depth = torch.where(alpha > 0, color[..., 3:], torch.inf)
    return {"blended": color[0, ..., :3], "A": alpha[0, ..., 0], "Z.expected": depth[0, ..., 0]}


# The programs, with the settings that each has.
PROGRAMS = {
    "inria": (inria, {"degree"}),
    "mip": (mip, {"degree", "low_pass"}),
    "2dgs": (surfels, {"degree"}),
    "gsplat": (gsplat, {"degree", "near_depth", "low_pass", "compensation"}),
}


def draw(torch, name, folder):
    """Draws one scene into a folder of its own; returns why not, if the program cannot."""
    if not (folder / "harmonics.npy").exists():
        return "it has surfels"
    (program, settable), described = PROGRAMS[name], json.loads((folder / "scene.json").read_text())
    usual = json.loads((folder.parent / "middle" / "scene.json").read_text())["settings"]
    camera, settings = described["camera"], described["settings"]
    if described["surface"]:
        return "the program tests no depths"
    unlike = {setting for setting in settings if settings[setting] != usual[setting]} - settable
    if name == "gsplat" and settings["compensation"] not in ("none", "ratio"):
        return "the program has no such compensation"
    if unlike:
        return f"the program has no {', '.join(sorted(unlike))}"
    if name != "gsplat" and camera["projection"] == "orthographic":
        return "the camera is orthographic"
    names = ("positions", "scales", "rotations", "opacities", "harmonics")
    scene = {name: torch.from_numpy(np.load(folder / f"{name}.npy")).cuda() for name in names}
    scene["harmonics"] = scene["harmonics"].reshape(len(scene["positions"]), -1, 3)
    scene["rotations"] = scene["rotations"][:, [3, 0, 1, 2]].contiguous()  # w first
    stored = int(scene["harmonics"].shape[1] ** 0.5) - 1
    planes = program(torch, scene, camera, settings | {"degree": min(stored, settings["degree"])})
    if described["environment"] != "black":
        planes.pop("A", None)  # where an environment is seen, a picture is opaque
    out = folder / name
    out.mkdir(exist_ok=True)
    for plane, values in planes.items():
        np.save(out / f"{plane}.npy", values.detach().cpu().numpy().astype(np.float32))
    (out / "client.toml").write_text("[planes]\n" + "".join(f'"{plane}" = "{plane}.npy"\n' for plane in planes))
    return None


def main(name, suite):
    try:
        import torch
    except ImportError:
        return print("SKIPPED: torch is not installed: install it with CUDA")
    if not torch.cuda.is_available():
        return print("SKIPPED: torch sees no CUDA device")
    for path in sorted(pathlib.Path(suite).glob("*/scene.json")):
        why = draw(torch, name, path.parent)
        print(f"{path.parent.name}: {'drawn' if why is None else 'not drawn: ' + why}")


if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[1] not in PROGRAMS:
        sys.exit(f"give a program, one of {', '.join(PROGRAMS)}, and the folder of a suite")
    main(*sys.argv[1:])
