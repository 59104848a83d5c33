"""An EWA rasterizer in numpy, or in torch if it is installed, held against splatref.

    python examples/python/torch_rasterizer.py

First its low-pass filter is wrong, and the verdict names it; then it is right.
"""

import numpy as np

import splatref as sr

try:
    import torch as xp

    array, numbers = xp.as_tensor, lambda tensor: tensor.numpy()
except ImportError:
    xp, array, numbers = np, np.asarray, np.asarray


def project(surfels, camera, k, h):
    """The footprints of all surfels on the screen, in float32: see the rustdoc of splat::project."""
    f32 = lambda values: array(np.asarray(values, np.float32))  # noqa: E731
    view = np.diag([1, -1, -1, 1]) @ camera.world_to_camera  # +y up, the camera looks along -z
    turn, move = view[:3, :3].T, view[:3, 3]
    px, py, pz = f32(surfels["positions"] @ turn + move).T
    nx, ny, nz = f32(surfels["normals"] @ turn).T
    r, (fx, fy), (cx, cy) = f32(surfels["radii"]), np.diag(camera.K)[:2].tolist(), camera.K[:2, 2].tolist()
    t = -pz
    m = 1 / t
    dx, dy, sx, sy = px * m, py * m, fx * m, fy * m
    g = nx * dx + ny * dy - nz  # below 0 the front is seen
    c = (-(dx * ny), dx * nx - nz, ny)
    e = (nz - dy * ny, dy * nx, -nx)
    dot = lambda a, b: a[0] * b[0] + a[1] * b[1] + a[2] * b[2]  # noqa: E731
    rx, ry = r / k * sx, r / k * sy
    xx, xy, yy, area = rx * rx * dot(c, c), -(rx * ry * dot(c, e)), ry * ry * dot(e, e), abs(rx * ry * g)
    det = area * area + h * (xx + yy) + h * h  # the low-pass filter adds h to both variances
    xx, yy = xx + h, yy + h
    ux, vy, half = xp.sqrt(yy / det), 1 / xp.sqrt(yy), r * xp.sqrt(nx * nx + ny * ny)
    footprints = [cx + fx * dx, cy - fy * dy, ux, -(xy / yy) * ux, vy, m, m * nx / (fx * g), -m * ny / (fy * g)]
    footprints += [1 / (t + half), 1 / (t - half), area / xp.sqrt(det), k * xp.sqrt(xx), k * xp.sqrt(yy)]
    return np.stack([numbers(part) for part in footprints], axis=1), numbers(g) < 0


def rasterize(surfels, camera, k, h, epsilon):
    """Two passes over the splats: the nearest depth of each pixel, then sums over those near it."""
    (width, height), (splats, front) = camera.size, project(surfels, camera, k, h)
    nearness, ids = np.zeros((height, width), np.float32), np.full((height, width), sr.NO_ID, np.uint32)
    weight, color = np.zeros((height, width), np.float32), np.zeros((height, width, 3), np.float32)
    for attributes in (False, True):
        for i in np.flatnonzero(front):
            x, y, ux, uy, vy, w0, wx, wy, far, near, amplitude, ex, ey = splats[i]
            x0, x1 = max(0, int(x - ex)), min(width, int(x + ex) + 1)
            y0, y1 = max(0, int(y - ey)), min(height, int(y + ey) + 1)
            if x0 >= x1 or y0 >= y1:
                continue
            at = np.s_[y0:y1, x0:x1]
            dx = array(np.arange(x0, x1, dtype=np.float32)[None] + np.float32(0.5) - x)
            dy = array(np.arange(y0, y1, dtype=np.float32)[:, None] + np.float32(0.5) - y)
            u, v = float(ux) * dx + float(uy) * dy, float(vy) * dy
            q, w = numbers(u * u + v * v), numbers(float(w0) + float(wx) * dx + float(wy) * dy)
            w = np.clip(w, far, near)
            inside = q <= k * k
            if not attributes:
                nearer = inside & (w > nearness[at])
                nearness[at] = np.where(nearer, w, nearness[at])
                ids[at] = np.where(nearer, np.uint32(i), ids[at])
                continue
            with np.errstate(divide="ignore"):
                inside &= 1 / w <= 1 / nearness[at] + np.float32(epsilon)
            share = np.where(inside, amplitude * numbers(xp.exp(array(-0.5 * q))), np.float32(0))
            weight[at] += share
            color[at] += share[..., None] * surfels["colors"][i]
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = np.where(nearness > 0, 1 / nearness, np.float32(np.inf))
        resolved = np.where(weight[..., None] > 0, color / weight[..., None], np.float32(0))
    stages = {"visibility.Z": depth, "visibility.id": ids, "attributes.weight": weight}
    return stages | {"attributes.RGB": color, "resolved.RGB": resolved}


scene = sr.Scene.open("torus", count=1500)  # all of it is in sight, so that nothing needs clipping
surfels, camera = scene.surfels, scene.camera(sr.Camera(size=(80, 60)))
settings = {setting.name: setting.defaults.get("ewa") for setting in sr.methods.settings("ewa")}
epsilon = float(settings["epsilon"].removesuffix("r")) * scene.median_radius
k, h = float(settings["cutoff"]), float(settings["low_pass"])
print("drawn by", xp.__name__)

wrong = sr.verify(scene, camera, rasterize(surfels, camera, k, h / 2, epsilon))
print(wrong)
assert not wrong.right and "low-pass" in wrong.causes[0]

right = sr.verify(scene, camera, rasterize(surfels, camera, k, h, epsilon))
print(right)
assert right.right
