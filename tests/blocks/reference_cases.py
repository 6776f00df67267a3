"""References that move in general ways: a maker, values of the parameters, and points with their times."""

from functools import cache

import brunovsky as br

B = br.blocks
POINTS = [[0.0, 0.0], [0.4, 1.1], [1.5, 1.3], [1.2, 2.9], [0.3, 3.4]]
TIMES = [-0.8, 0.0, 1.3, 2.0, 3.3]
BOUNDARY = {
    "start[1]": -0.3, "start[2]": 0.4, "end[1]": 1.7, "end[2]": 2.1, "start_velocity[1]": -0.5,
    "start_velocity[2]": 0.8, "end_velocity[1]": 0.6, "end_velocity[2]": 0.2, "start_time": -0.2, "duration": 2.7,
}  # fmt: skip
ACCELERATIONS = {
    "start_acceleration[1]": 0.3, "start_acceleration[2]": 0.1, "end_acceleration[1]": -0.7, "end_acceleration[2]": 0.2,
}  # fmt: skip
CASES = {
    "lemniscate": (cache(B.lemniscate), {"center[1]": 0.4, "half_width": 1.3, "rate": -0.7, "phase": 0.3}),
    "polynomial": (cache(B.polynomial), BOUNDARY | ACCELERATIONS),
    "polynomial, free": (cache(lambda: B.polynomial(acceleration="free")), BOUNDARY),
    "waypoints": (cache(lambda: B.waypoints(POINTS, TIMES)), {}),
    "waypoints, free": (cache(lambda: B.waypoints(POINTS, TIMES, acceleration="free")), {"point[2,1]": 0.6}),
}
