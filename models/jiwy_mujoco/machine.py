"""JIWY in MuJoCo: a base with two posts, a fork that pans between them, and a camera that tilts in the fork.

Units are those of MuJoCo: metres, kilograms, seconds, radians. Friction, inertia and motors are those of
``models/jiwy/plant.csp``; the end stops are contacts between a peg and two posts.
"""

from math import asin, cos, pi, sin

import mujoco

RATIO = 5.3
TORQUE_CONSTANT = 0.0234
RESISTANCE = 2.18
DRIVE = 0.85 * RATIO * TORQUE_CONSTANT / RESISTANCE
"""Torque at the joint for a volt at the motor that does not turn, in N m/V."""
INDUCTION = RATIO * TORQUE_CONSTANT
"""Voltage that the turning joint induces, in V s/rad."""
ROTOR = RATIO**2 * 1.03e-6
"""Inertia of the rotor, as the joint feels it, in kg m²."""
COUNT = 2 * pi / (4096 * RATIO)
"""The angle of the joint for one count of the encoder."""
STEP = 0.0005

STOPS = {"pan": (-1.62, 1.5), "tilt": (-2.05, 1.85)}
ARM, RADIUS = 0.06, 0.004
"""How far pegs and posts are from the axis, and their radius."""


def _posts(joint: str) -> tuple[tuple[float, float], ...]:
    """Where the axes of the two posts are, in the plane in which the peg turns."""
    width = 2 * asin(RADIUS / ARM)
    least, greatest = STOPS[joint]
    return tuple((ARM * cos(angle), ARM * sin(angle)) for angle in (least - width, greatest + width))


def _post_on_base(place: tuple[float, float]) -> str:
    x, y = place
    return f'<geom class="stop" type="cylinder" size="{RADIUS} 0.012" pos="{x:.6f} {y:.6f} 0.052"/>'


def _post_in_fork(place: tuple[float, float]) -> str:
    x, z = place
    place_in_fork = f"{x:.6f} -0.048 {0.09 - z:.6f}"
    return f'<geom class="stop" type="cylinder" size="{RADIUS} 0.008" pos="{place_in_fork}" euler="1.5707963 0 0"/>'


MODEL = f"""
<mujoco model="jiwy">
  <compiler angle="radian" autolimits="true"/>
  <option timestep="{STEP}" integrator="implicitfast" cone="elliptic"><flag filterparent="disable"/></option>
  <visual>
    <global offwidth="640" offheight="480"/><quality shadowsize="2048"/>
    <headlight ambient="0.45 0.45 0.45" diffuse="0.4 0.4 0.4"/>
  </visual>
  <asset>
    <texture name="sky" type="skybox" builtin="gradient" rgb1="0.97 0.98 1" rgb2="0.78 0.84 0.9"
      width="64" height="64"/>
    <texture name="tiles" type="2d" builtin="checker" rgb1="0.88 0.9 0.92" rgb2="0.82 0.84 0.87"
      width="128" height="128"/>
    <material name="floor" texture="tiles" texrepeat="12 12"/>
  </asset>
  <default>
    <geom contype="0" conaffinity="0" rgba="0.22 0.45 0.68 1"/>
    <default class="stop">
      <geom contype="1" conaffinity="1" solref="0.004 1" solimp="0.95 0.99 0.0005"
        friction="0.1" rgba="0.82 0.32 0.2 1"/>
    </default>
  </default>
  <worldbody>
    <light pos="0.4 -0.5 0.9" dir="-0.4 0.5 -0.8" directional="true" diffuse="0.5 0.5 0.5"/>
    <camera name="side" pos="0.21 -0.27 0.2" xyaxes="0.79 0.61 0 -0.23 0.3 0.93" fovy="42"/>
    <geom type="plane" size="1 1 0.1" material="floor" rgba="1 1 1 1"/>
    <geom type="cylinder" size="0.075 0.02" pos="0 0 0.02" rgba="0.35 0.38 0.42 1"/>
    {"".join(map(_post_on_base, _posts("pan")))}
    <body name="pan" pos="0 0 0">
      <joint name="pan" axis="0 0 1" damping="1e-3" frictionloss="0.012" armature="{ROTOR}"/>
      <inertial mass="0.3" pos="0 0 0.06" diaginertia="8e-4 8e-4 8e-4"/>
      <geom type="cylinder" size="0.05 0.004" pos="0 0 0.046"/>
      <geom type="box" size="0.012 0.004 0.03" pos="0 0.042 0.08"/>
      <geom type="box" size="0.012 0.004 0.03" pos="0 -0.042 0.08"/>
      <geom type="cylinder" size="0.066 0.001" pos="0 -0.039 0.09" euler="1.5707963 0 0" rgba="0.6 0.75 0.9 0.35"/>
      <geom class="stop" type="cylinder" size="{RADIUS} 0.012" pos="{ARM} 0 0.052" rgba="0.95 0.75 0.2 1"/>
      {"".join(map(_post_in_fork, _posts("tilt")))}
      <body name="tilt" pos="0 0 0.09">
        <joint name="tilt" axis="0 1 0" damping="5e-4" frictionloss="0.008" armature="{ROTOR}"/>
        <inertial mass="0.15" pos="0 0 -0.0068" diaginertia="2e-4 3e-4 2e-4"/>
        <geom type="capsule" size="0.006" fromto="0 -0.046 0 0 0.046 0" rgba="0.5 0.53 0.57 1"/>
        <geom type="box" size="0.026 0.028 0.02" rgba="0.3 0.32 0.36 1"/>
        <geom type="cylinder" size="0.014 0.012" pos="0.036 0 0" euler="0 1.5707963 0" rgba="0.18 0.18 0.2 1"/>
        <geom type="cylinder" size="0.011 0.001" pos="0.0485 0 0" euler="0 1.5707963 0" rgba="0.45 0.7 0.9 1"/>
        <geom class="stop" type="cylinder" size="{RADIUS} 0.008" pos="{ARM} -0.048 0" euler="1.5707963 0 0"
          rgba="0.95 0.75 0.2 1"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <general name="pan" joint="pan" gainprm="{DRIVE}" biastype="affine" biasprm="0 0 {-DRIVE * INDUCTION}"/>
    <general name="tilt" joint="tilt" gainprm="{DRIVE}" biastype="affine" biasprm="0 0 {-DRIVE * INDUCTION}"/>
  </actuator>
</mujoco>
"""


class Machine:
    """The machine, which begins at rest at the angles ``pan`` and ``tilt``."""

    def __init__(self, *, pan: float, tilt: float) -> None:
        self._start = (pan, tilt)
        self._model = mujoco.MjModel.from_xml_string(MODEL)
        self._data = mujoco.MjData(self._model)
        self.reset()

    def reset(self) -> None:
        """Time 0: at rest, the encoders at zero."""
        mujoco.mj_resetData(self._model, self._data)
        self._data.qpos[:] = self._start

    def calculate(self, voltage_pan: float, voltage_tilt: float, time: float) -> tuple[float, float, float, float]:
        """Move to ``time`` with the voltages held; the counts of both encoders as angles, and the angles."""
        steps = round((time - self._data.time) / STEP)
        self._data.ctrl[:] = voltage_pan, voltage_tilt
        mujoco.mj_step(self._model, self._data, steps)
        pan, tilt = self._data.qpos.tolist()
        return self._counted(pan, 0), self._counted(tilt, 1), pan, tilt

    def _counted(self, angle: float, joint: int) -> float:
        return round((angle - self._start[joint]) / COUNT) * COUNT
