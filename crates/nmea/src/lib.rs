//! NMEA 0183 and IEC 61162-450 sentences, in and out.
