"""A running arm as topics of ROS 2, over DDS, without ROS."""
