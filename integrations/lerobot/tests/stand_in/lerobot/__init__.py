"""Stand-in for LeRobot, with no more of its interface than the plug-in uses. Written from its documentation; none of its code."""
