"""A firm's part of a work order, by the client that openapi-python-client makes."""

import pathlib
import sys
from uuid import UUID

from binnacle_client import AuthenticatedClient
from binnacle_client.api.adjusting import (
    accept_work_order,
    choose_plan,
    complete_work_order,
    find_evidence,
    find_plan,
    find_record,
    find_work_order,
    go_on_board,
    list_work_orders,
    print_record,
    read_berth,
    read_step,
)
from binnacle_client.models.berth_reading import BerthReading
from binnacle_client.models.completion import Completion
from binnacle_client.models.offer_answer import OfferAnswer
from binnacle_client.models.on_board import OnBoard
from binnacle_client.models.plan_choice import PlanChoice
from binnacle_client.models.step_reading import StepReading
import json

server, token, order_id, folder = sys.argv[1:]
folder = pathlib.Path(folder)
order_id = UUID(order_id)
client = AuthenticatedClient(base_url=server, token=token, raise_on_unexpected_status=True)


def done(call, *arguments, **named):
    response = call.sync_detailed(*arguments, client=client, **named)
    if response.status_code.value >= 300:
        sys.exit(f"{call.__name__}: {response.content.decode()}")
    return response


def change(call, *arguments, body, key):
    return done(call, *arguments, body=body, idempotency_key=key).parsed


listed = done(list_work_orders).parsed
assert [order.id for order in listed.items] == [order_id]
assert done(find_work_order, order_id).parsed.state == "offered"
who = {"adjuster_name": "M. Etxeberria", "adjuster_licence": "ES-CA-114"}
order = change(accept_work_order, order_id, body=OfferAnswer.from_dict(who), key="accept")
# The same key again changes nothing more.
assert change(accept_work_order, order_id, body=OfferAnswer.from_dict(who), key="accept") == order
change(go_on_board, order_id, body=OnBoard(), key="on board")
reading = BerthReading.from_dict(json.loads((folder / "reading.json").read_text()))
change(read_berth, order_id, body=reading, key="reading")
plans = done(find_plan, order_id).parsed.plans
assert plans[0].steps[0].setting_after is not None
order = change(choose_plan, order_id, body=PlanChoice(plan=1), key="plan")
while order.next_step is not None:
    step = order.next_step
    read = StepReading(after_deg=step.expected_compass_deg)
    order = change(read_step, order_id, step.number, body=read, key=f"step {step.number}")
word = Completion.from_dict({**who, "firm": "rosa", "signature": "M. Etxeberria"})
order = change(complete_work_order, order_id, body=word, key="complete")
assert order.state == "adjusted"
record = done(find_record, order_id)
assert record.parsed["order"] == str(order_id)
(folder / "record.json").write_bytes(record.content)
for call, name in [(print_record, "record.pdf"), (find_evidence, "evidence.zip")]:
    (folder / name).write_bytes(done(call, order_id).parsed.payload.read())
print(order.completion.record_sha256)
