"""Named constants of the program."""

from __future__ import annotations

from .runtime import ms

rotorInertia = 1.03e-06  # plant.csp:5

# Gear between motor and joint (published).
ratio = 5.3  # plant.csp:7

# Counts of the encoder in a revolution of the joint: 1024 lines on the motor shaft, counted fourfold.
counts = 21708.8  # plant.csp:11

# Stiffness of the end stops (assumed).
stiffness = 50.0  # plant.csp:13

# Torque at the joint for a volt at the motor that stands still.
drive = 0.04835642201834862  # plant.csp:16

# Voltage that the turning joint induces.
induction = 0.12402  # plant.csp:18

# Nominal supply of the amplifiers; a duty of 1 is this voltage.
supply = 12.0  # laws.csp:2

# Sample period of the horizontal joint.
Tsh = 2 * ms  # jiwy.csp:5

# Sample period of the vertical joint.
Tsv = 1 * ms  # jiwy.csp:7

# What the joystick reports when its stop button is pressed.
stopButton = 2  # jiwy.csp:9
