# SPDX-License-Identifier: MIT
"""Stands in for the node of slam_toolbox: a plain one, as in Humble, or with STAND_IN=lifecycle one with a lifecycle, as
in newer releases. Appends its parameters and transitions to the file RECORD, one JSON text a line."""

import json
import os

import rclpy
from lifecycle_msgs.msg import State, Transition, TransitionEvent
from lifecycle_msgs.srv import ChangeState
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

# The states in which a transition begins, and which it passes and reaches.
WAYS = {Transition.TRANSITION_CONFIGURE: ("unconfigured", "configuring", "inactive"),
        Transition.TRANSITION_ACTIVATE: ("inactive", "activating", "active")}
STATES = {"unconfigured": State.PRIMARY_STATE_UNCONFIGURED, "inactive": State.PRIMARY_STATE_INACTIVE,
          "active": State.PRIMARY_STATE_ACTIVE, "configuring": State.TRANSITION_STATE_CONFIGURING,
          "activating": State.TRANSITION_STATE_ACTIVATING}


def record(key, value):
    with open(os.environ["RECORD"], "a") as file:
        file.write(json.dumps({key: value}) + "\n")


class StandIn(Node):
    def __init__(self):
        super().__init__("slam_toolbox", automatically_declare_parameters_from_overrides=True)
        if os.environ["STAND_IN"] == "lifecycle":
            self.state = "unconfigured"
            self.events = self.create_publisher(TransitionEvent, "~/transition_event", 10)
            self.service = self.create_service(ChangeState, "~/change_state", self.change)
        values = self.get_parameters_by_prefix("")
        record("parameters", {name: each.value for name, each in values.items() if "." not in name})

    def change(self, request, response):
        way = WAYS.get(request.transition.id)
        response.success = way is not None and way[0] == self.state
        if response.success:
            record("transition", request.transition.id)
            self.state = way[2]
            for before, after in zip(way, way[1:]):
                start, goal = (State(id=STATES[each], label=each) for each in (before, after))
                self.events.publish(TransitionEvent(start_state=start, goal_state=goal))
        return response


rclpy.init()
try:
    rclpy.spin(StandIn())
except (KeyboardInterrupt, ExternalShutdownException):
    pass
