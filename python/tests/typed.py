"""What a user writes, for mypy: it is checked, not run."""

import numpy as np

import splatref as sr

scene = sr.Scene(np.zeros((3, 3), np.float32), normals=np.ones((3, 3)), radii=0.1)
camera = sr.Camera(K=np.eye(3), world_to_camera=np.eye(4), size=(64, 48), convention="opencv")
picture: sr.Picture = sr.render(scene, camera, method="ewa", epsilon="1.5r", number="f64", stages=True)
pictures: list[sr.Picture] = sr.render(scene, [camera, camera])
depth: np.ndarray = picture["Z"]
verdict = sr.verify(scene, camera, {"visibility.Z": depth, "rgb": picture["RGB"]}, promise="gpu")
right: bool = verdict.right
worst: sr.Worst | None = verdict.worst
error: float = sr.metrics.flip(picture, picture["RGB"])
found: sr.Study = sr.study(scene, camera, method="ewa", truth="bunny.ply", epsilon="1.5r")
front: list[sr.Candidate] = found.front("ssim")
milliseconds: float | None = front[0].time
order: np.ndarray = sr.surfels.greedy(depth, count=10)
lawful: sr.laws.Counterexample | None = sr.laws.over(lambda below, alpha_below, alpha, color: (color, alpha))
sr.testing.assert_right(scene, camera, picture, promise="ieee")
