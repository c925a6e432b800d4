"""A firm's part of a work order, by the client that openapi-generator makes."""

import pathlib
import sys
from uuid import UUID

import binnacle_openapi as api

server, token, order_id, folder = sys.argv[1:]
folder = pathlib.Path(folder)
order_id = UUID(order_id)
client = api.ApiClient(api.Configuration(host=server, access_token=token))
orders = api.AdjustingApi(client)

assert [order.id for order in orders.list_work_orders().items] == [order_id]
assert orders.find_work_order(order_id).state == "offered"
who = {"adjuster_name": "M. Etxeberria", "adjuster_licence": "ES-CA-114"}
order = orders.accept_work_order(order_id, api.OfferAnswer.from_dict(who), idempotency_key="accept")
# The same key again changes nothing more.
again = orders.accept_work_order(order_id, api.OfferAnswer.from_dict(who), idempotency_key="accept")
assert again == order
orders.go_on_board(order_id, api.OnBoard(), idempotency_key="on board")
reading = api.BerthReading.from_json((folder / "reading.json").read_text())
orders.read_berth(order_id, reading, idempotency_key="reading")
plans = orders.find_plan(order_id).plans
assert plans[0].steps[0].setting_after is not None
order = orders.choose_plan(order_id, api.PlanChoice(plan=1), idempotency_key="plan")
while order.next_step is not None:
    step = order.next_step
    read = api.StepReading(after_deg=step.expected_compass_deg)
    order = orders.read_step(order_id, step.number, read, idempotency_key=f"step {step.number}")
word = api.Completion.from_dict({**who, "firm": "rosa", "signature": "M. Etxeberria"})
order = orders.complete_work_order(order_id, word, idempotency_key="complete")
assert order.state == "adjusted"
assert orders.find_record(order_id)["order"] == str(order_id)
record = orders.find_record_without_preload_content(order_id)
(folder / "record.json").write_bytes(record.data)
(folder / "record.pdf").write_bytes(orders.print_record(order_id))
(folder / "evidence.zip").write_bytes(orders.find_evidence(order_id))
print(order.completion.record_sha256)
