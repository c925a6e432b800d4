/** Photographs made small enough for a bad connection. */

const longestSidePx = 1600;
const smallEnoughBytes = 600_000;
const quality = 0.8;

/** The photograph as it is sent; an error when the browser cannot read it. */
export async function smaller(file: Blob): Promise<Blob> {
  const image = await createImageBitmap(file);
  const share = Math.min(1, longestSidePx / Math.max(image.width, image.height));
  if (share === 1 && file.size <= smallEnoughBytes && isTaken(file.type)) return file;
  const canvas = document.createElement('canvas');
  canvas.width = Math.max(1, Math.round(image.width * share));
  canvas.height = Math.max(1, Math.round(image.height * share));
  canvas.getContext('2d')?.drawImage(image, 0, 0, canvas.width, canvas.height);
  image.close();
  const made = await new Promise<Blob | null>((done) => {
    canvas.toBlob(done, 'image/jpeg', quality);
  });
  if (!made) throw new Error('the browser made no picture');
  return made;
}

/** Kinds that the server takes. */
const isTaken = (type: string) => ['image/jpeg', 'image/png', 'image/webp'].includes(type);
