/** The keys that a firm signs with, as its own people see them. */

import { translate } from './language';

export const signing = translate('signing', {
  title: 'Signing keys',
  lead: 'Your firm signs its records with a key. Whoever reads the evidence of a record is told that a registered key is yours.',
  none: 'None is registered: what your firm signs is said to be of an unknown key.',
  notYours: 'People of a firm that adjusts compasses have signing keys.',
  add: 'Register a key',
  registered: 'The key is registered.',
  revoke: 'Revoke',
  revokeNamed: (name: string) => `Revoke ${name}`,
  revokeQuestion:
    'What it signed stays signed; it vouches for nothing from now on, and cannot be brought back.',
  revokeConfirm: 'Revoke it',
  isRevoked: 'The key is revoked.',
  form: {
    name: 'Name',
    nameMissing: 'Give the key a name, such as “Office, 2026”.',
    lead: 'Without a key of your own, have one made in this browser. Its private half is yours alone: it is not sent, and not kept here.',
    make: 'Make a key',
    cannotMake: 'This browser cannot make one: it has to be recent, and the page open over TLS.',
    made: 'A key was made. Save its private half now, where only your firm can read it: it is not shown again.',
    save: 'Save the private key',
    notSaved: 'Save the private key first: without it nobody can sign.',
    own: 'Its public half and proof',
    ownLead: (said: string) =>
      `The proof is the key’s signature over “${said}”. OpenSSL makes a key, and then the two fields:`,
    commands: 'Commands for OpenSSL',
    key: 'Public key, 64 hexadecimal digits',
    keyWrong: 'The public key is not 64 hexadecimal digits.',
    proof: 'Proof, 128 hexadecimal digits',
    proofWrong: 'The proof is not 128 hexadecimal digits.',
    submit: 'Register it',
    busy: 'Registering…',
  },
});
