"""Reads logs as other programs do: with MCAP's own library, each message by its schema, well-known ones by Foxglove's own definitions.

Arguments: logs.
"""

import importlib
import json
import re
import sys

from google.protobuf import json_format
from jsonschema import Draft202012Validator
from mcap.reader import make_reader

# Of each topic so many messages are checked by their schema: that is slow.
CHECKED = 200


def well_known(name):
    """Foxglove's own definition of a schema, as a class of messages."""
    word = name.removeprefix("foxglove.")
    return getattr(importlib.import_module(f"foxglove_schemas_protobuf.{word}_pb2"), word)


def as_protobuf(value):
    """Times and durations are objects in MCAP's JSON and strings in protobuf's."""
    if isinstance(value, dict):
        if value.keys() == {"sec", "nsec"}:
            return None
        return {key: each for key, each in ((key, as_protobuf(each)) for key, each in value.items()) if each is not None}
    if isinstance(value, list):
        return [as_protobuf(each) for each in value]
    return value


def check(messages, topics):
    """Checks each message; counts them in `topics`."""
    validators = {}
    for schema, channel, message in messages:
        count = topics[channel.topic] = topics.get(channel.topic, 0) + 1
        if count > CHECKED:
            continue
        if schema.encoding != "jsonschema" or channel.message_encoding != "json":
            raise ValueError(f"{channel.topic}: neither JSON nor a JSON schema")
        if schema.id not in validators:
            text = json.loads(schema.data)
            Draft202012Validator.check_schema(text)
            validators[schema.id] = Draft202012Validator(text)
        content = json.loads(message.data)
        validators[schema.id].validate(content)
        if schema.name.startswith("foxglove."):
            json_format.ParseDict(as_protobuf(content), well_known(schema.name)())
        elif channel.topic == "/telemetry":
            for name, value in content.items():
                if not re.fullmatch(r"[a-z_]+", name) or not isinstance(value, (int, float)):
                    raise ValueError(f"{channel.topic}: {name} = {value!r} is nothing that a plot can show")


def main():
    for path in sys.argv[1:]:
        topics = {}
        with open(path, "rb") as file:
            reader = make_reader(file, validate_crcs=True)
            summary = reader.get_summary()
            if summary is None or summary.statistics is None or not summary.chunk_indexes:
                raise ValueError(f"{path}: no index")
            check(reader.iter_messages(), topics)
            if sum(topics.values()) != summary.statistics.message_count:
                raise ValueError(f"{path}: the index counts other messages")
        if not topics:
            raise ValueError(f"{path}: no message")
        print(f"{path}: " + ", ".join(f"{topic} {count}" for topic, count in sorted(topics.items())))


main()
