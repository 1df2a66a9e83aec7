/* Lariat in C#, through the functions of lariat.h: embed.c's beam, and the sentence for a scene that
 * is not there.
 *     mcs Embed.cs && LD_LIBRARY_PATH=PREFIX/lib mono Embed.exe beam.yaml
 * In .NET the same file serves. On Debian with liblariat0 installed LD_LIBRARY_PATH is not needed.
 */
using System;
using System.Runtime.InteropServices;
using System.Text;

static class Lariat {
    const string Library = "liblariat.so.0";

    [StructLayout(LayoutKind.Sequential)]
    public struct Error { // lar_error
        public int Status;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 1016)] public byte[] Message;

        public override string ToString() {
            int length = Array.IndexOf(Message, (byte)0);
            return Encoding.UTF8.GetString(Message, 0, length < 0 ? Message.Length : length);
        }
    }

    // Handles free what they own, also where something throws.
    public class Model : SafeHandle {
        public Model() : base(IntPtr.Zero, true) {}
        public override bool IsInvalid { get { return handle == IntPtr.Zero; } }
        protected override bool ReleaseHandle() { lar_model_destroy(handle); return true; }
    }
    public class Simulation : SafeHandle {
        public Simulation() : base(IntPtr.Zero, true) {}
        public override bool IsInvalid { get { return handle == IntPtr.Zero; } }
        protected override bool ReleaseHandle() { lar_simulation_destroy(handle); return true; }
    }

    [DllImport(Library)] static extern void lar_model_destroy(IntPtr model);
    [DllImport(Library)] static extern void lar_simulation_destroy(IntPtr simulation);
    [DllImport(Library)] static extern IntPtr lar_version();
    [DllImport(Library)] static extern IntPtr lar_model_positions(Model model);
    [DllImport(Library)] static extern int lar_model_open(byte[] path, out Model model, out Error error);
    // lar_simulation_create, told how large the options are (none here): lariat_sizes.h.
    [DllImport(Library)] static extern int lar_simulation_create_sized(
        Model model, IntPtr options, UIntPtr size, out Simulation simulation, out Error error);
    [DllImport(Library)] static extern int lar_simulation_advance(
        Simulation simulation, ulong steps, out Error error);
    [DllImport(Library, EntryPoint = "lar_model_node_count")]
    public static extern int NodeCount(Model model);
    [DllImport(Library, EntryPoint = "lar_simulation_time_step")]
    public static extern double TimeStep(Simulation simulation);
    [DllImport(Library, EntryPoint = "lar_simulation_hash")]
    public static extern ulong Hash(Simulation simulation);
    [DllImport(Library, EntryPoint = "lar_simulation_displacements")]
    public static extern void Displacements(Simulation simulation, [Out] double[,] displacement);

    static void Check(int status, Error error) {
        if (status != 0) throw new InvalidOperationException(error.ToString());
    }
    public static string Version() { return Marshal.PtrToStringAnsi(lar_version()); }
    public static Model Open(string path) {
        Model model;
        Error error;
        Check(lar_model_open(Encoding.UTF8.GetBytes(path + "\0"), out model, out error), error);
        return model;
    }
    public static Simulation Create(Model model) {
        Simulation simulation;
        Error error;
        Check(lar_simulation_create_sized(model, IntPtr.Zero, UIntPtr.Zero, out simulation, out error),
              error);
        return simulation;
    }
    public static void Advance(Simulation simulation, ulong steps) {
        Error error;
        Check(lar_simulation_advance(simulation, steps, out error), error);
    }
    public static double[] Positions(Model model) { // x, y, z of every node
        double[] position = new double[3 * NodeCount(model)];
        Marshal.Copy(lar_model_positions(model), position, 0, position.Length);
        return position;
    }
}

static class Program {
    static int Main(string[] arguments) {
        Console.Error.WriteLine("lariat " + Lariat.Version());
        try {
            // A simulation goes before its model: `using` closes the last one first.
            using (Lariat.Model model = Lariat.Open(arguments.Length > 0 ? arguments[0] : "beam.yaml"))
            using (Lariat.Simulation simulation = Lariat.Create(model)) {
                Lariat.Advance(simulation, (ulong)(0.1 / Lariat.TimeStep(simulation)));
                double[] position = Lariat.Positions(model);
                double[,] displacement = new double[Lariat.NodeCount(model), 3];
                Lariat.Displacements(simulation, displacement);
                int tip = 0; // the node farthest along x
                for (int i = 1; i < Lariat.NodeCount(model); i++)
                    if (position[3 * i] > position[3 * tip]) tip = i;
                Console.WriteLine(string.Format(System.Globalization.CultureInfo.InvariantCulture,
                                                "tip {0:F9} m", displacement[tip, 2]));
                Console.WriteLine("hash {0:x16}", Lariat.Hash(simulation));
            }
        } catch (InvalidOperationException refused) {
            Console.Error.WriteLine(refused.Message);
            return 1;
        }
        return 0;
    }
}
