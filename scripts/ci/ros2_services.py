# SPDX-License-Identifier: MIT
# For scripts/ci/ros2: Cyclone DDS of PyPI calls services of g4-ros2, with the header of rmw_cyclonedds.
import time
from dataclasses import dataclass, field

from cyclonedds.core import Policy, Qos
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.annotations import final
from cyclonedds.idl.types import byte, float64, int64, sequence, uint64
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration


@dataclass
@final
class ParameterValue(IdlStruct, typename="rcl_interfaces::msg::dds_::ParameterValue_"):
    type: byte = 0
    bool_value: bool = False
    integer_value: int64 = 0
    double_value: float64 = 0.0
    string_value: str = ""
    byte_array_value: sequence[byte] = field(default_factory=list)
    bool_array_value: sequence[bool] = field(default_factory=list)
    integer_array_value: sequence[int64] = field(default_factory=list)
    double_array_value: sequence[float64] = field(default_factory=list)
    string_array_value: sequence[str] = field(default_factory=list)


@dataclass
@final
class Parameter(IdlStruct, typename="rcl_interfaces::msg::dds_::Parameter_"):
    name: str
    value: ParameterValue


@dataclass
@final
class SetParametersResult(IdlStruct, typename="rcl_interfaces::msg::dds_::SetParametersResult_"):
    successful: bool
    reason: str


@dataclass
@final
class GetRequest(IdlStruct, typename="rcl_interfaces::srv::dds_::GetParameters_Request_"):
    client: uint64
    number: int64
    names: sequence[str]


@dataclass
@final
class GetReply(IdlStruct, typename="rcl_interfaces::srv::dds_::GetParameters_Response_"):
    client: uint64
    number: int64
    values: sequence[ParameterValue]


@dataclass
@final
class SetRequest(IdlStruct, typename="rcl_interfaces::srv::dds_::SetParameters_Request_"):
    client: uint64
    number: int64
    parameters: sequence[Parameter]


@dataclass
@final
class SetReply(IdlStruct, typename="rcl_interfaces::srv::dds_::SetParameters_Response_"):
    client: uint64
    number: int64
    results: sequence[SetParametersResult]


def call(participant, name, request, reply_type):
    qos = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(10))
    reader = DataReader(participant, Topic(participant, f"rr/g4lidar/{name}Reply", reply_type), qos=qos)
    writer = DataWriter(participant, Topic(participant, f"rq/g4lidar/{name}Request", type(request)), qos=qos)
    end = time.monotonic() + 30
    while not (writer.get_matched_subscriptions() and reader.get_matched_publications()):
        assert time.monotonic() < end, name
        time.sleep(0.01)
    writer.write(request)
    while time.monotonic() < end:
        for reply in reader.take(10):
            if (reply.client, reply.number) == (request.client, request.number):
                return reply
        time.sleep(0.01)
    raise AssertionError(f"{name}: no reply")


def check_services(participant):
    values = call(participant, "get_parameters", GetRequest(7, 1, ["grid", "frame_id"]), GetReply).values
    assert (values[0].integer_value, values[1].string_value) == (720, "laser"), values
    wanted = [Parameter("range_max", ParameterValue(type=3, double_value=value)) for value in (50.0, -1.0)]
    results = call(participant, "set_parameters", SetRequest(7, 2, wanted), SetReply).results
    assert [each.successful for each in results] == [True, False], results
    return 2
