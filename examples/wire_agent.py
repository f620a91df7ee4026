"""A robot's mind over the wire of docs/wire.md, without hthor: `hthor eval --agent "cmd:python wire_agent.py"`.

Goes ahead while the way is free, else turns; tells people when it sees the target, and answers "Where is the mug?" when
it has seen one. Needs msgspec (or msgpack).
"""

import sys

import msgspec.msgpack as msgpack


def send(message):
    body = msgpack.encode(message)
    sys.stdout.buffer.write(len(body).to_bytes(4, "little") + body)
    sys.stdout.buffer.flush()


def receive():
    head = sys.stdin.buffer.read(4)
    return msgpack.decode(sys.stdin.buffer.read(int.from_bytes(head, "little"))) if len(head) == 4 else {"type": "end"}


def ask(what):
    send({"type": "ask", "what": what})
    return receive()["value"]


def act(look, target, seen):
    ranges = memoryview(ask("scan")["ranges"]["d"]).cast("d")
    action = {"motion": {"type": "move", "forward": 0.3}}
    if min(ranges[len(ranges) // 3 : 2 * len(ranges) // 3]) < 0.6:
        action = {"motion": {"type": "rotate", "yaw": 0.7}}
    found = {thing["kind"]: thing for thing in ask("detections")}
    seen.update(found)
    if target in found and look["receipt"] is None:
        action["say"] = {"type": "send", "text": f"Here is the {target}.", "object": found[target]["id"]}
    for message in look["inbox"]:
        if message["question"] and (thing := asked_for(message, seen)):
            action["say"] = {
                "type": "send",
                "text": f"I saw the {thing['kind'].replace('_', ' ')} there.",
                "object": thing["id"],
                "position": thing["position"],
                "answers": message["id"],
            }
    return action


def asked_for(message, seen):
    """The thing that a question is about, if it was seen: the question names it by id or kind, or only in its words."""
    for kind, thing in seen.items():
        if message["object"] in (thing["id"], kind) or (
            not message["object"] and kind.replace("_", " ") in message["text"].lower()
        ):
            return thing
    return None


send({"type": "ready", "wire": 2, "name": "wire-agent", "doc": "Goes ahead, looks.", "privileges": ["ideal_detector"]})
target, seen = "", {}
while (message := receive())["type"] != "end":
    if message["type"] == "begin":
        target, seen = message["briefing"]["target"], {}
        send({"type": "done"})
    else:
        send({"type": "acted", "action": act(message["observation"], target, seen)})
