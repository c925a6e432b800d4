-- What is written on a compass and its binnacle: a deviation card names it.
ALTER TABLE compasses ADD COLUMN make TEXT; -- maker and type
ALTER TABLE compasses ADD COLUMN serial_number TEXT;
ALTER TABLE compasses ADD COLUMN binnacle TEXT; -- its maker, type and number
