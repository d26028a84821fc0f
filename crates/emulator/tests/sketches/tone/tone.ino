// Four notes of 250 ms on pin 8.

const unsigned int notes_hz[] = {31, 440, 1000, 4978};

void setup() {
  for (unsigned int note : notes_hz) {
    tone(8, note, 250);
    delay(300);
  }
}

void loop() {
}
