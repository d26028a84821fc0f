"""The robot's parameters as those of a node: rclpy's client of parameters, and one service as Cyclone speaks it."""

from dataclasses import dataclass

from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float64, int64, sequence, uint8, uint64
from rcl_interfaces.msg import ParameterEvent
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from ros_peers import PATIENCE_S, Page, wait_for

DOUBLE = Parameter.Type.DOUBLE


@dataclass
class Value(IdlStruct, typename="rcl_interfaces::msg::dds_::ParameterValue_"):
    type: uint8
    bool_value: bool
    integer_value: int64
    double_value: float64
    string_value: str
    byte_array_value: sequence[uint8]
    bool_array_value: sequence[bool]
    integer_array_value: sequence[int64]
    double_array_value: sequence[float64]
    string_array_value: sequence[str]


@dataclass
class GetRequest(IdlStruct, typename="rcl_interfaces::srv::dds_::GetParameters_Request_"):
    guid: uint64
    number: int64
    names: sequence[str]


@dataclass
class GetAnswer(IdlStruct, typename="rcl_interfaces::srv::dds_::GetParameters_Response_"):
    guid: uint64
    number: int64
    values: sequence[Value]


@dataclass
class ListRequest(IdlStruct, typename="rcl_interfaces::srv::dds_::ListParameters_Request_"):
    guid: uint64
    number: int64
    prefixes: sequence[str]
    depth: uint64


@dataclass
class ListAnswer(IdlStruct, typename="rcl_interfaces::srv::dds_::ListParameters_Response_"):
    guid: uint64
    number: int64
    names: sequence[str]
    prefixes: sequence[str]


def result(what, future):
    wait_for(what, future.done)
    return future.result()


def double(name, value):
    return Parameter(name, DOUBLE, value)


def check(peer, cyclone, robot):
    """The robot is off."""
    events = peer.listen(ParameterEvent, "/parameter_events", 100)
    client = AsyncParameterClient(peer.node, "rumbo")
    assert client.wait_for_services(PATIENCE_S)
    check_reading(client, cyclone)
    check_setting(client, events)
    check_refusals(peer, client, robot)
    # What is too long for the library is not sent to Fast DDS, and said.
    client.list_parameters()
    wait_for("why not", lambda: robot.said("too long for a client of Fast DDS"))
    return events


def ask(cyclone, service, kinds, **question):
    """An answer of a service of parameters to Cyclone."""
    answers = cyclone.read(f"rr/rumbo/{service}Reply", kinds[1], cyclone.volatile)
    requests = cyclone.write(f"rq/rumbo/{service}Request", kinds[0])
    wait_for("the service", lambda: requests.get_matched_subscriptions() and answers.get_matched_publications())
    requests.write(kinds[0](guid=5, number=6, **question))
    answer = wait_for("an answer", lambda: answers.take(N=1))[0]
    assert (answer.guid, answer.number) == (5, 6), answer
    return answer


def check_reading(client, cyclone):
    names = ask(cyclone, "list_parameters", (ListRequest, ListAnswer), prefixes=[], depth=0).names
    assert len(names) > 50 and "front_kp" in names and "rig" in names, names
    simulated = ask(cyclone, "get_parameters", (GetRequest, GetAnswer), names=["use_sim_time"]).values
    assert [(each.type, each.bool_value) for each in simulated] == [(1, True)], simulated
    assert result("one name", client.list_parameters(["rig"], 1)).result.names == ["rig"]
    front, rig, none = result("descriptions", client.describe_parameters(["front_kp", "rig", "no_such"])).descriptors
    limits = front.floating_point_range[0]
    assert (limits.from_value, limits.to_value, front.type) == (0.1, 20.0, 3), front
    assert front.description.endswith("[1/s]") and "final" in rig.additional_constraints, (front, rig)
    assert (none.name, none.type) == ("no_such", 0), none
    known = lambda some: [each.type for each in result("values", client.get_parameters(some)).values]
    for first in range(0, len(names), 16):
        wait_for("all values", lambda: 0 not in known(names[first : first + 16]))
    assert list(result("types", client.get_parameter_types(["rig", "front_kp", "no_such"])).types) == [4, 3, 0]
    values = ask(cyclone, "get_parameters", (GetRequest, GetAnswer), names=["rig", "front_kp"]).values
    assert [each.type for each in values] == [4, 3] and values[0].string_value == "final", values


def check_setting(client, events):
    events.clear()
    values = lambda names: [each.double_value for each in result("values", client.get_parameters(names)).values]
    # Each for itself: what is refused does not keep the others from being set.
    wanted = [double("front_kp", 3.25), double("front_kp", 99.0), double("no_such", 1.0), Parameter("rig", value=4)]
    wanted += [Parameter("mission_reset_origin", value=False), double("wall_ki", 0.5)]
    done = result("setting", client.set_parameters(wanted)).results
    assert [each.successful for each in done] == [True, False, False, False, True, True], done
    reasons = [each.reason for each in done]
    assert reasons[1] == "front_kp: 99 is not within 0.1 to 20 1/s", reasons
    assert "there is no parameter no_such" in reasons[2] and "it is a string" in reasons[3], reasons
    assert values(["front_kp", "wall_ki"]) == [3.25, 0.5]
    wait_for("the event", lambda: any(changed(event, "wall_ki") for event in events))
    assert any(changed(event, "front_kp") == 3.25 and event.node == "/rumbo" for event in events), events
    # All or none.
    done = result("setting", client.set_parameters_atomically([double("front_kp", 4.0), double("wall_ki", -1.0)])).result
    assert not done.successful and "wall_ki" in done.reason, done
    assert values(["front_kp", "wall_ki"]) == [3.25, 0.5]
    both = [double("front_kp", 5.0), double("wall_ki", 1.0), Parameter("mission_reset_origin", value=True)]
    done = result("setting", client.set_parameters_atomically(both)).result
    assert done.successful, done
    assert values(["front_kp", "wall_ki"]) == [5.0, 1.0]


def changed(event, name):
    return next((each.value.double_value for each in event.changed_parameters if each.name == name), None)


def check_refusals(peer, client, robot):
    # The robot's own: sonars do not move while it drives.
    peer.must("/rumbo/arm")
    done = result("setting", client.set_parameters([Parameter("rig", value="front_single")])).results[0]
    assert not done.successful and "disarm" in done.reason.lower(), done
    peer.must("/rumbo/disarm")
    # A page has control, until it releases it.
    page = Page(robot.url)
    page.order("take_control")
    set_one = lambda: result("setting", client.set_parameters([double("front_kp", 6.0)])).results[0]
    wait_for("control of the page", lambda: "another page has control" in set_one().reason)
    page.order("release_control")
    wait_for("control of none", lambda: set_one().successful)
    assert result("setting", client.set_parameters([double("front_kp", 5.0)])).results[0].successful


def check_two(peer):
    """A parameter of one of two robots."""
    first, second = (AsyncParameterClient(peer.node, name) for name in ("rumbo", "second/rumbo"))
    assert first.wait_for_services(PATIENCE_S) and second.wait_for_services(PATIENCE_S)
    assert result("setting", second.set_parameters([double("front_kp", 3.0)])).results[0].successful
    values = [result("a value", each.get_parameters(["front_kp"])).values[0].double_value for each in (first, second)]
    assert values == [5.0, 3.0], values
