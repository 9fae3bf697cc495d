"""Rigid-body motion, solved exactly where mathematics allows, on ROS 2."""
