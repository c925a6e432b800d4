import { createPrivateKey, createPublicKey, verify } from 'node:crypto';
import { expect, test } from 'vitest';
import { makeKey, proofCommands, readHex } from './keys';

test('a key that is made proves itself, and its file is the same key’s', async () => {
  const made = await makeKey('f-1');
  const held = createPublicKey(createPrivateKey(made.pem));
  expect(held.export({ format: 'der', type: 'spki' }).subarray(-32).toString('hex')).toBe(
    made.publicKey,
  );
  const proof = Buffer.from(made.proof, 'hex');
  expect(verify(null, Buffer.from('binnacle firm key f-1'), held, proof)).toBe(true);
  expect(verify(null, Buffer.from('binnacle firm key f-2'), held, proof)).toBe(false);
});

test('digits are taken as a terminal shows them, and no others', () => {
  expect(readHex(' 0aFF\n12 ', 6)).toBe('0aff12');
  expect(readHex('0aff1', 6)).toBeNull();
  expect(readHex('0aff1g', 6)).toBeNull();
});

test('the commands sign the firm’s own text', () => {
  expect(proofCommands('f-1')).toContain("printf 'binnacle firm key f-1' > text");
});
