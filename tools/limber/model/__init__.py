"""Robots and scenarios as the tools need them; kinematics and dynamics independent of the C++."""
