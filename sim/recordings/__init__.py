"""Recordings as robots: CARMEN logs and ROS bags whose readings come as if they were being taken now."""
