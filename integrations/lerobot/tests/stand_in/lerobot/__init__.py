# SPDX-License-Identifier: Apache-2.0
"""Stand-in for LeRobot, with no more of its interface than the plug-in uses. Written from its documentation; none of its code."""
