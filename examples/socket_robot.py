"""A robot of a live session, without hthor: `python socket_robot.py "ws://127.0.0.1:8765/robot#TOKEN"`.

`hthor live --agent socket` prints the address. The robot looks round, goes on where there is room, and sends people a
message with the place of the target when it sees it. Needs websockets and msgspec (or msgpack); see docs/wire.md.
"""

import sys

import msgspec.msgpack as msgpack
from websockets.sync.client import connect

ROUND, TURN, STEPS = 9, 0.7, 6  # so many turns [rad] look once round; then it goes on for so many steps


def main(address):
    address, token = address.split("#")
    with connect(address, subprotocols=["hthor.wire", token], max_size=None) as socket:

        def send(**message):
            socket.send(msgpack.encode(message))

        def ask(what):
            send(type="ask", what=what)
            return msgpack.decode(socket.recv())["value"]

        send(type="ready", wire=2, name="socket-robot", doc="Looks round, and tells.", privileges=["ideal_detector"])
        for body in socket:  # ends with the session
            message = msgpack.decode(body)
            if message["type"] == "begin":
                target, count = message["briefing"]["target"], 0
                send(type="done")
            elif message["type"] == "look":
                ranges = memoryview(ask("scan")["ranges"]["d"]).cast("d")
                room = min(ranges[len(ranges) // 3 : 2 * len(ranges) // 3])
                turn = count % (ROUND + STEPS) < ROUND or room < 0.6
                action = {"motion": {"type": "rotate", "yaw": TURN} if turn else {"type": "move", "forward": 0.4}}
                count += 1
                found = [thing for thing in ask("detections") if thing["kind"] == target]
                if found and message["observation"]["receipt"] is None:
                    action["say"] = tell(found[0])
                send(type="acted", action=action)


def tell(thing):
    x, y, z = thing["position"]
    text = f"The {thing['kind'].replace('_', ' ')} is at {x:.1f}, {y:.1f}."
    return {"type": "send", "text": text, "object": thing["id"], "position": [x, y, z]}


if __name__ == "__main__":
    main(sys.argv[1])
