"""What the thesis prints (Real-Time Finite Elements: A Parallel Computer Application,
2001). Curves of its figures are not here: the text that we have holds their captions only."""

STEP_GOAL = 100e-6           # [s] 4.2
STEP_REACHED = 200e-6        # [s] 8.2: "just under 200 us", 12 nodes with two threads
PROCESSORS = 24
PEAK_SHARE = 1 / 3           # 4.3, reached: 6.10
ELEMENT_OPERATIONS = 816     # 4.2.3
ELEMENT_SECONDS = 2e-6       # table 6.1
ELEMENT_FLOPS = 500e6        # 6.10
PEAK_FLOPS = 1332e6          # two operations a clock at 666 MHz, 4.3
CRITICAL = 150               # elements, 8.3.1
CRITICAL_LARGE = 450         # expected inside a larger grid, 8.3.1

PACKET_BYTES = 424           # mean, figure 7.2
STEP_BYTES = 40000           # all processors, 4.3
PROCESSOR_BANDWIDTH = 54e6   # [B/s] of the node that sends most, 8.1
TOTAL_BANDWIDTH = 225e6      # [B/s] 8.1

# 7.3.1: packets that reach half of the peak bandwidth, and the mean bandwidth for the packets of
# the simulation, from which the peak follows: mean (1 + half / packet).
HALF_BYTES = 196
MEAN_BANDWIDTH = 111         # [MB/s]
MPI_HALF_BYTES = 1963
MPI_MEAN_BANDWIDTH = 20      # [MB/s]
MPI_LAM_LATENCY = 80         # [us] "80 us to several hundred"

TABLE_6_1 = (
    ("original code, g++, 21164A at 500 MHz", 15),
    ("original code, ccc, 21164A at 500 MHz", 8),
    ("optimised code, ccc, 21164A at 500 MHz", 3),
    ("optimised code, ccc, 21264A at 666 MHz", 2),
    ("optimised code, g++, 21264A at 666 MHz", 5.5),
)


def bandwidth(size, half, peak):
    """[MB/s] of packets of so many bytes, when half of the peak is reached with `half`."""
    return peak * size / (size + half)


PEAK_BANDWIDTH = MEAN_BANDWIDTH * (1 + HALF_BYTES / PACKET_BYTES)
MPI_PEAK_BANDWIDTH = MPI_MEAN_BANDWIDTH * (1 + MPI_HALF_BYTES / PACKET_BYTES)
