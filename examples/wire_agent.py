"""A robot's mind over the wire of docs/wire.md, without hthor: `hthor eval --agent "cmd:python wire_agent.py"`.

Goes ahead while the way is free, else turns; tells the person when it sees the target. Needs msgspec (or msgpack).
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


def act(look, target):
    ranges = memoryview(ask("scan")["ranges"]["d"]).cast("d")
    action = {"motion": {"type": "move", "forward": 0.3}}
    if min(ranges[len(ranges) // 3 : 2 * len(ranges) // 3]) < 0.6:
        action = {"motion": {"type": "rotate", "yaw": 0.7}}
    for thing in ask("detections"):
        if thing["kind"] == target and look["receipt"] is None:
            action["say"] = {"type": "send", "text": f"Here is the {target}.", "object": thing["id"]}
    return action


send({"type": "ready", "name": "wire-agent", "doc": "Goes ahead and looks.", "privileges": ["ideal_detector"]})
target = ""
while (message := receive())["type"] != "end":
    if message["type"] == "begin":
        target = message["briefing"]["target"]
        send({"type": "done"})
    else:
        send({"type": "acted", "action": act(message["observation"], target)})
