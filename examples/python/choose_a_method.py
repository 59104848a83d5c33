"""Charts the speed of each method against its accuracy for a scene, as a matplotlib figure.

    python examples/python/choose_a_method.py [scene] [chart.png]

Without matplotlib it prints the numbers alone. `splatref plan` does the same for every setting.
"""

import sys
import time

import splatref as sr

ROUNDS = 3  # the shortest time counts
METHODS = ["ewa", "single-pass", "pyramid", "template", "blue"]

name = sys.argv[1] if len(sys.argv) > 1 else "torus"
scene = sr.Scene.open(name, count=5000) if name == "torus" else sr.Scene.open(name)
camera = sr.Camera(size=(160, 120))
truth = sr.truth(scene, camera)  # 8 x 8 rays a pixel, in f64

rows = []
for method in METHODS:
    picture, milliseconds = sr.render(scene, camera, method=method), float("inf")
    for _ in range(ROUNDS):
        start = time.perf_counter()
        picture = sr.render(scene, camera, method=method)
        milliseconds = min(milliseconds, 1000 * (time.perf_counter() - start))
    errors = sr.metrics.errors(picture, truth)
    rows.append((method, milliseconds, errors["rmse"], errors["flip"]))
    print("{:12} {:7.2f} ms   RMSE {:.4f}   FLIP {:.4f}".format(*rows[-1]))

# No other method is both faster and more accurate than these.
front = [row for row in rows if not any(o[1] <= row[1] and o[2] < row[2] for o in rows)]
print("choose among:", ", ".join(row[0] for row in front))
if name == "torus":
    # Times vary from run to run; errors never do.
    assert [row[0] for row in rows if row[2] <= 0.03] == ["pyramid", "template", "blue"]

try:
    import matplotlib
except ImportError:
    print("no matplotlib, so no chart")
else:
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(6, 4))
    axes.scatter([row[1] for row in rows], [row[2] for row in rows])
    for method, milliseconds, rmse, _ in rows:
        axes.annotate(method, (milliseconds, rmse), textcoords="offset points", xytext=(5, 5))
    front.sort(key=lambda row: row[1])
    axes.step([row[1] for row in front], [row[2] for row in front], where="post", alpha=0.4)
    axes.set(xscale="log", xlabel="milliseconds a picture", ylabel="RMSE, linear RGB", title=f"{name}, {scene.count} surfels")
    chart = sys.argv[2] if len(sys.argv) > 2 else "choose_a_method.png"
    figure.savefig(chart, bbox_inches="tight")
    print("wrote", chart)
