"""Judges an arm by the frames on its CAN buses and robot.yaml alone.

Written apart: its decoders and rules share no code with the driver and its gate.
"""
