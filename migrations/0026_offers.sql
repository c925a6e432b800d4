-- Orders are offered to firms. What was said stands in the order's log; here is how each
-- firm's offer stands after the last entry, so that a firm's orders can be found.
CREATE TABLE work_order_offers (
    vessel_id UUID NOT NULL,
    order_id UUID NOT NULL,
    firm_id UUID NOT NULL REFERENCES firms (id),
    state TEXT NOT NULL CHECK (state IN ('waiting', 'open', 'proposed', 'accepted', 'declined',
                                         'lapsed', 'withdrawn')),
    answer_by BIGINT, -- while an answer is waited for
    PRIMARY KEY (vessel_id, order_id, firm_id),
    FOREIGN KEY (vessel_id, order_id) REFERENCES work_orders (vessel_id, id)
);
CREATE INDEX work_order_offers_by_firm ON work_order_offers (firm_id, order_id);

ALTER TABLE work_orders ADD COLUMN firm_id UUID; -- the firm that has accepted it
ALTER TABLE work_orders ADD COLUMN answer_by BIGINT; -- the first answer that is waited for
CREATE INDEX work_orders_by_answer ON work_orders (answer_by);
DROP INDEX work_orders_one_open;
CREATE UNIQUE INDEX work_orders_one_open ON work_orders (vessel_id, compass_id)
    WHERE state IN ('planned', 'offered', 'proposed', 'declined', 'accepted', 'on_board',
                    'measured', 'adjusting');
