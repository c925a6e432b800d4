/** The keys that a firm signs records with: what proves that one holds a key, and a new one. */

/** What a key signs to be registered. */
export const proofText = (firm: string): string => `binnacle firm key ${firm}`;

/** How the two are made of a key that is in `firm.pem`, by OpenSSL. */
export const proofCommands = (firm: string): string =>
  [
    'openssl genpkey -algorithm ED25519 -out firm.pem',
    'openssl pkey -in firm.pem -pubout -outform DER | tail -c 32 | xxd -p -c 32',
    `printf '${proofText(firm)}' > text`,
    'openssl pkeyutl -sign -rawin -inkey firm.pem -in text | xxd -p -c 64',
  ].join('\n');

/** Hexadecimal digits without what a terminal puts between them; `null` if they are not so many. */
export function readHex(typed: string, digits: number): string | null {
  const bare = typed.replace(/\s/g, '').toLowerCase();
  return bare.length === digits && /^[0-9a-f]*$/.test(bare) ? bare : null;
}

export interface MadeKey {
  publicKey: string;
  proof: string;
  /** The private half as PKCS #8, which no one else has. */
  pem: string;
}

/** Makes a key; nothing of its private half leaves the device. */
export async function makeKey(firm: string): Promise<MadeKey> {
  const pair = await crypto.subtle.generateKey('Ed25519', true, ['sign', 'verify']);
  if (!('privateKey' in pair)) throw new Error('no key pair was made');
  const { privateKey, publicKey } = pair;
  const said = new TextEncoder().encode(proofText(firm));
  const secret = new Uint8Array(await crypto.subtle.exportKey('pkcs8', privateKey));
  return {
    publicKey: hex(await crypto.subtle.exportKey('raw', publicKey)),
    proof: hex(await crypto.subtle.sign('Ed25519', privateKey, said)),
    pem: `-----BEGIN PRIVATE KEY-----\n${btoa(String.fromCharCode(...secret))}\n-----END PRIVATE KEY-----\n`,
  };
}

const hex = (bytes: ArrayBuffer): string =>
  Array.from(new Uint8Array(bytes), (byte) => byte.toString(16).padStart(2, '0')).join('');
