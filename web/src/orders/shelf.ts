/**
 * What the browser keeps for work with a bad connection: writes that are not answered
 * yet, and orders as they were last seen.
 *
 * What always holds: a promise that is fulfilled means that it is kept, also when the
 * page is closed at once. Where a browser keeps nothing (a private window), it is kept
 * as long as the page is open, and `durable` says so.
 */

import type { BinnacleRevision, PlanOffer, WorkOrder } from '../api/types';
import type { Write } from './writes';

/** An order as it was last seen, with what is needed to go on without a connection. */
export interface Kept {
  id: string;
  /** Who saw it: what is kept for one is not shown to another. */
  user: string;
  order: WorkOrder;
  offer?: PlanOffer | undefined;
  /** What the planner was asked. */
  offeredFor: string;
  binnacle?: BinnacleRevision | undefined;
  at: string;
}

export interface Shelf {
  durable: boolean;
  /** All writes in their order. */
  writes: () => Promise<Write[]>;
  /** Keeps a new write; its number. */
  add: (write: Omit<Write, 'seq'>) => Promise<number>;
  change: (write: Write) => Promise<void>;
  remove: (seq: number) => Promise<void>;
  order: (id: string) => Promise<Kept | undefined>;
  orders: () => Promise<Kept[]>;
  /** Keeps an order; what the page has of it is copied. */
  keep: (kept: Kept) => Promise<void>;
  forgetOrders: () => Promise<void>;
}

/** The browser's own database, or memory where there is none. */
export async function openShelf(): Promise<Shelf> {
  try {
    return inDatabase(await database());
  } catch {
    return inMemory();
  }
}

function database(): Promise<IDBDatabase> {
  return new Promise((done, fail) => {
    const opening = indexedDB.open('binnacle-orders', 1);
    opening.onupgradeneeded = () => {
      opening.result.createObjectStore('writes', { keyPath: 'seq', autoIncrement: true });
      opening.result.createObjectStore('orders', { keyPath: 'id' });
    };
    opening.onsuccess = () => {
      done(opening.result);
    };
    opening.onerror = () => {
      fail(opening.error ?? new Error('the browser keeps no data'));
    };
  });
}

type Name = 'writes' | 'orders';

function inDatabase(db: IDBDatabase): Shelf {
  const run = <T>(
    name: Name,
    mode: IDBTransactionMode,
    act: (s: IDBObjectStore) => IDBRequest<T>,
  ) =>
    new Promise<T>((done, fail) => {
      // Strict: it is on the disk when the transaction is complete.
      const transaction = db.transaction(name, mode, { durability: 'strict' });
      const request = act(transaction.objectStore(name));
      transaction.oncomplete = () => {
        done(request.result);
      };
      transaction.onabort = () => {
        fail(transaction.error ?? new Error('the browser did not keep it'));
      };
    });
  return {
    durable: true,
    writes: () =>
      run<Write[]>('writes', 'readonly', (store) => store.getAll() as IDBRequest<Write[]>),
    add: async (write) => Number(await run('writes', 'readwrite', (store) => store.add(write))),
    change: async (write) => {
      await run('writes', 'readwrite', (store) => store.put(write));
    },
    remove: async (seq) => {
      await run('writes', 'readwrite', (store) => store.delete(seq));
    },
    order: (id) =>
      run<Kept | undefined>(
        'orders',
        'readonly',
        (store) => store.get(id) as IDBRequest<Kept | undefined>,
      ),
    orders: () =>
      run<Kept[]>('orders', 'readonly', (store) => store.getAll() as IDBRequest<Kept[]>),
    keep: async (kept) => {
      await run('orders', 'readwrite', (store) => store.put(kept));
    },
    forgetOrders: async () => {
      await run('orders', 'readwrite', (store) => store.clear());
    },
  };
}

/** A shelf that lasts as long as the page. */
export function inMemory(): Shelf {
  const writes = new Map<number, Write>();
  const orders = new Map<string, Kept>();
  let last = 0;
  return {
    durable: false,
    writes: () => Promise.resolve([...writes.values()].sort((a, b) => a.seq - b.seq)),
    add: (write) => {
      writes.set(++last, { ...write, seq: last });
      return Promise.resolve(last);
    },
    change: (write) => {
      if (writes.has(write.seq)) writes.set(write.seq, write);
      return Promise.resolve();
    },
    remove: (seq) => {
      writes.delete(seq);
      return Promise.resolve();
    },
    order: (id) => Promise.resolve(orders.get(id)),
    orders: () => Promise.resolve([...orders.values()]),
    keep: (kept) => {
      orders.set(kept.id, kept);
      return Promise.resolve();
    },
    forgetOrders: () => {
      orders.clear();
      return Promise.resolve();
    },
  };
}
