"""A first robot folder and scenario for an arm of which there is only a URDF."""
